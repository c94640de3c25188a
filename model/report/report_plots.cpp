#include "model/report/report_plots.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "config/units.hpp"
#include "model/compare/loops.hpp"
#include "model/report/report_page.hpp"
#include "model/report/svg_plot.hpp"
#include "model/table/signals.hpp"

namespace fogbench::model {
namespace {

constexpr std::size_t kMostPoints = 2000;
constexpr std::size_t kMostBranches = 24;

/// One per row of the table, NaN where there is none.
using RowValues = std::vector<double>;

/// A fit as a plot draws it.
struct Layer {
  const FitResult& fit;
  std::string kind;
  SvgPlot::Mark mark;
};

/// The comparison's fit, and the one after it if there is one.
std::vector<Layer> layers_of(const PlottedFits& fits) {
  if (!fits.after) return {{fits.comparison.fit, "point", SvgPlot::Mark::kDot}};
  return {{fits.comparison.fit, "before", SvgPlot::Mark::kSquare},
          {*fits.after, "after", SvgPlot::Mark::kDot}};
}

/// `values` as the fit has them: one for each row that took part.
RowValues by_table_row(const PlottedFits& fits, const FitResult& fit,
                       const Eigen::VectorXd& values) {
  RowValues out(fits.table.rows(), kMissing);
  for (std::size_t i = 0; i < fit.rows.size(); ++i) {
    out[fit.rows[i]] = values[static_cast<Eigen::Index>(i)];
  }
  return out;
}

/// A signal in the unit that it is plotted in: time in hours.
RowValues plotted_values(const PlottedFits& fits, const Signals& signals,
                         const std::string& variable) {
  RowValues out(fits.table.rows(), kMissing);
  const double scale = variable == "time_s" ? 3600.0 : 1.0;
  const Signals::View values = signals.signal(variable);
  for (std::size_t i = 0; i < signals.rows(); ++i) {
    out[signals.table_row(i)] = values[static_cast<Eigen::Index>(i)] / scale;
  }
  return out;
}

/// Variables that were cut into ranges, in the order of how badly their worst range fails; time in
/// any case.
std::vector<std::string> plotted_variables(const PlottedFits& fits, const Signals& signals) {
  std::vector<std::string> out;
  const auto add = [&](const std::string& variable) {
    if (variable.empty() || !signals.available(variable)) return;
    if (std::find(out.begin(), out.end(), variable) == out.end()) out.push_back(variable);
  };
  for (const Region& region : fits.comparison.regions) add(region.variable);
  add("time_s");
  return out;
}

/// Evenly thinned, the same in all plots, in the order of the table.
std::vector<std::size_t> plotted_rows(const PlottedFits& fits) {
  const std::vector<std::size_t>& rows = fits.comparison.fit.rows;
  const std::size_t stride = (rows.size() + kMostPoints - 1) / kMostPoints;
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < rows.size(); i += stride) out.push_back(rows[i]);
  std::sort(out.begin(), out.end());
  return out;
}

/// Axes, zero line and noise of a plot of residuals.
SvgPlot residual_axes(const PlottedFits& fits, const std::string& title,
                      const std::string& variable) {
  return {.title = title,
          .x_label = heading_of(variable),
          .y_label = "measured - model" + with_unit(config::unit_of(fits.model.observable)),
          .zero_line = true,
          .envelope = std::isfinite(fits.noise_floor) ? 2.0 * fits.noise_floor : 0.0};
}

/// The plot, with what is drawn of the second fit alone on axes of its own, for the page's switch.
std::string figure(const SvgPlot& plot, const std::string& caption = "") {
  SvgPlot together = plot, alone = plot;
  std::erase_if(alone.series,
                [](const SvgPlot::Series& s) { return !s.kind.starts_with("after"); });
  const bool two = !alone.series.empty();
  if (two) together.kind = "together";
  alone.kind = "alone";
  const std::string svg = together.svg();
  if (svg.empty()) return "";
  return "<figure>" + svg + (two ? alone.svg() : "") +
         (caption.empty() ? "" : "<figcaption>" + escaped(caption) + "</figcaption>") +
         "</figure>\n";
}

/// An entry of a legend: `picture` is SVG on 28 by 14.
std::string legend_entry(std::string_view kind, std::string_view picture, std::string_view words) {
  return fmt::format("<li class=\"{}\"><svg viewBox=\"0 0 28 14\">{}</svg>{}</li>\n", kind, picture,
                     words);
}

/// The layers' points over x.
void add_series(SvgPlot& plot, const PlottedFits& fits, const RowValues& x) {
  for (const Layer& layer : layers_of(fits)) {
    const RowValues residual = by_table_row(fits, layer.fit, layer.fit.residual);
    SvgPlot::Series series{.kind = layer.kind, .mark = layer.mark};
    for (std::size_t row : plotted_rows(fits)) {
      series.points.emplace_back(x[row], residual[row]);
      series.rows.push_back(std::to_string(row));
    }
    plot.series.push_back(std::move(series));
  }
}

/// Whether the row belongs to a region of text: "segment coil_z/down", "sweep coil_z".
bool stands_in(const Region& region, const std::string& segment) {
  return region.where == "segment " + segment ||
         region.where == "sweep " + segment.substr(0, segment.find('/'));
}

/// When a segment or sweep was measured, h: from the first to the last of its rows that follow one
/// another.
std::vector<std::pair<double, double>> times_of(const Region& region, const PlottedFits& fits,
                                                const Signals& signals, const RowValues& hours) {
  std::vector<std::pair<double, double>> out;
  bool inside = false;
  for (std::size_t i = 0; i < signals.rows(); ++i) {
    const std::size_t row = signals.table_row(i);
    const bool stands = stands_in(region, fits.table.segment().at(row));
    if (stands && !inside) out.emplace_back(hours[row], hours[row]);
    if (stands) out.back().second = hours[row];
    inside = stands;
  }
  return out;
}

/// The failing regions of the variable; on the axis of time those of segments and sweeps too, where
/// one run has one axis of time. The caption is the worst one's sentence.
std::string add_bands(SvgPlot& plot, const PlottedFits& fits, const Signals& signals,
                      const std::string& variable, const RowValues& x) {
  const bool time = variable == "time_s" && signals.runs().size() == 1;
  const double scale = variable == "time_s" ? 3600.0 : 1.0;
  const std::vector<const Region*> failing = failing_regions(fits.comparison);
  std::string caption;
  for (std::size_t k = 0; k < failing.size(); ++k) {
    const Region& region = *failing[k];
    std::vector<std::pair<double, double>> places;
    if (region.variable == variable) places = {{region.from / scale, region.to / scale}};
    if (time && region.variable.empty()) places = times_of(region, fits, signals, x);
    for (const auto& [from, to] : places) {
      plot.bands.push_back({from, to, region.says, std::to_string(k + 1)});
    }
    if (caption.empty() && !places.empty()) caption = fmt::format("{}: {}", k + 1, region.says);
  }
  return caption;
}

/// What leaves loops behind; over less than this it stands still and only noise goes up and down.
struct Driver {
  const char* variable;
  double least_range;
};
constexpr std::array<Driver, 4> kDrivers = {
    {{"field_x_ut", 5.0}, {"field_y_ut", 5.0}, {"field_z_ut", 5.0}, {"temperature_c", 1.0}}};

bool moves(const RowValues& values, double least_range) {
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (double value : values) {
    if (!std::isfinite(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  return high - low >= least_range;
}

/// Mean of the rows' values, leaving out what is missing.
double mean_of(const RowValues& values, const std::vector<std::size_t>& rows) {
  double sum = 0.0, count = 0.0;
  for (std::size_t row : rows) {
    if (std::isnan(values[row])) continue;
    sum += values[row];
    count += 1.0;
  }
  return count > 0.0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
}

/// One polyline for the branch; it begins where the branch before it ended. A stop stands for
/// those of its rows that the other plots show.
SvgPlot::Series branch_series(const Branch& branch, const Branch* before, const RowValues& x,
                              const RowValues& y, const std::vector<std::size_t>& plotted) {
  SvgPlot::Series series{.joined = true};
  const auto add = [&](const std::vector<std::size_t>& stop) {
    series.points.emplace_back(mean_of(x, stop), mean_of(y, stop));
    std::vector<std::size_t> shown;
    for (std::size_t row : stop) {
      if (std::binary_search(plotted.begin(), plotted.end(), row)) shown.push_back(row);
    }
    series.rows.push_back(shown.empty() ? "-" : fmt::format("{}", fmt::join(shown, ",")));
  };
  if (before && branch.continues) add(before->stops.back());
  for (const auto& stop : branch.stops) add(stop);
  return series;
}

}  // namespace

std::vector<const Region*> failing_regions(const Comparison& comparison) {
  std::vector<const Region*> out;
  if (!comparison.noise_known) return out;
  for (const Region& region : comparison.regions) {
    if (region.p_family_wise < kAdequate) out.push_back(&region);
  }
  return out;
}

std::string measured_against_model(const PlottedFits& fits) {
  const std::string unit = with_unit(config::unit_of(fits.model.observable));
  SvgPlot plot{.title = "Measured against model",
               .x_label = "model" + unit,
               .y_label = "measured" + unit,
               .diagonal = true};
  for (const Layer& layer : layers_of(fits)) {
    const RowValues model = by_table_row(fits, layer.fit, layer.fit.predicted);
    const RowValues residual = by_table_row(fits, layer.fit, layer.fit.residual);
    SvgPlot::Series series{.kind = layer.kind, .mark = layer.mark};
    for (std::size_t row : plotted_rows(fits)) {
      series.points.emplace_back(model[row], model[row] + residual[row]);
      series.rows.push_back(std::to_string(row));
    }
    plot.series.push_back(std::move(series));
  }
  return figure(plot);
}

std::string residual_plots(const PlottedFits& fits) {
  const Signals signals(fits.table, fits.model.reference_temperature_c);
  std::string out;
  for (const std::string& variable : plotted_variables(fits, signals)) {
    SvgPlot plot = residual_axes(fits, "Residual by " + heading_of(variable), variable);
    const RowValues x = plotted_values(fits, signals, variable);
    add_series(plot, fits, x);
    const std::string caption = add_bands(plot, fits, signals, variable, x);
    out += figure(plot, caption);
  }
  return out;
}

std::string plot_legend(const PlottedFits& fits) {
  std::string out;
  if (fits.after) {
    out += legend_entry("before", R"(<path class="marks before" d="M11 4h7v7h-7z"/>)",
                        "before: the model as it came");
    out += legend_entry("after", R"(<path class="dots after" stroke-width="7" d="M14 7h0"/>)",
                        "after: with what was added");
  }
  if (fits.noise_floor > 0.0) {
    out += legend_entry("key", R"(<line class="noise" x1="0" y1="7" x2="28" y2="7"/>)",
                        "twice the noise floor");
  }
  if (!failing_regions(fits.comparison).empty()) {
    out += legend_entry("key", R"(<rect class="band" width="28" height="14"/>)",
                        "the model fails by more than noise; numbered, worst first");
  }
  return out.empty() ? out : "<ul class=\"legend\">\n" + out + "</ul>\n";
}

std::string loop_plots(const PlottedFits& fits) {
  const Signals signals(fits.table, fits.model.reference_temperature_c);
  const std::vector<std::size_t> plotted = plotted_rows(fits);
  std::string out;
  for (const auto& [variable, least_range] : kDrivers) {
    if (!signals.available(variable)) continue;
    const RowValues x = plotted_values(fits, signals, variable);
    if (!moves(x, least_range)) continue;
    std::vector<Branch> branches = branches_of(signals, variable);
    if (branches.empty()) continue;
    const std::size_t passes = branches.size();
    branches.resize(std::min(passes, kMostBranches));
    SvgPlot plot = residual_axes(fits, "Loop over " + heading_of(variable), variable);
    for (const Layer& layer : layers_of(fits)) {
      const RowValues residual = by_table_row(fits, layer.fit, layer.fit.residual);
      const bool first = &layer.fit == &fits.comparison.fit;
      for (std::size_t b = 0; b < branches.size(); ++b) {
        SvgPlot::Series series =
            branch_series(branches[b], b > 0 ? &branches[b - 1] : nullptr, x, residual, plotted);
        series.mark = branches[b].rising ? SvgPlot::Mark::kRight : SvgPlot::Mark::kLeft;
        series.kind =
            first ? fmt::format("{} {}", layer.kind, branches[b].rising ? "rising" : "falling")
                  : "after thin";
        plot.series.push_back(std::move(series));
      }
    }
    out += figure(plot, passes > kMostBranches
                            ? fmt::format("The first {} of {} passes.", kMostBranches, passes)
                            : "");
  }
  return out;
}

std::string loop_legend(const PlottedFits& fits) {
  const bool two = fits.after != nullptr;
  std::string out = "<ul class=\"legend\">\n";
  out += legend_entry(two ? "before" : "key",
                      R"(<path class="joint rising" d="M0 7h28"/>)"
                      R"(<path class="marks rising" d="M18 7l-8 -4v8z"/>)",
                      two ? "rising, before" : "rising");
  out += legend_entry(two ? "before" : "key",
                      R"(<path class="joint falling" d="M0 7h28"/>)"
                      R"(<path class="marks falling" d="M10 7l8 -4v8z"/>)",
                      two ? "falling, before" : "falling");
  if (two) {
    out += legend_entry("after", R"(<path class="joint after thin" d="M0 7h28"/>)",
                        "both directions, with what was added");
  }
  return out + "</ul>\n";
}

std::string rows_json(const PlottedFits& fits) {
  const Signals signals(fits.table, fits.model.reference_temperature_c);
  nlohmann::json names = {"row", fits.table.run_word(), "segment"}, rows = nlohmann::json::object();
  std::vector<RowValues> columns;
  for (const std::string& variable : plotted_variables(fits, signals)) {
    names.push_back(heading_of(variable));
    columns.push_back(plotted_values(fits, signals, variable));
  }
  for (const Layer& layer : layers_of(fits)) {
    names.push_back((fits.after ? "residual " + layer.kind : "residual") +
                    with_unit(config::unit_of(fits.model.observable)));
    columns.push_back(by_table_row(fits, layer.fit, layer.fit.residual));
  }
  for (std::size_t row : plotted_rows(fits)) {
    nlohmann::json line = {row + 1, fits.table.run().at(row), fits.table.segment().at(row)};
    for (const RowValues& column : columns) line.push_back(number_text(column[row], ""));
    rows[std::to_string(row)] = std::move(line);
  }
  const nlohmann::json all = {{"names", names}, {"rows", rows}};
  // ASCII, whatever bytes the texts hold; '<' must not end the script element that holds it.
  std::string text = all.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
  for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at)) {
    text.replace(at, 1, "\\u003c");
  }
  return text;
}

}  // namespace fogbench::model
