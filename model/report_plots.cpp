#include "model/report_plots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "config/units.hpp"
#include "model/loops.hpp"
#include "model/report_page.hpp"
#include "model/signals.hpp"
#include "model/svg_plot.hpp"

namespace fogbench::model {
namespace {

constexpr std::size_t kMostPoints = 2000;
constexpr std::size_t kMostBranches = 24;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

using Values = std::vector<double>;  // one per row of the table, NaN where there is none

Values by_table_row(const PlottedFits& fits, const FitResult& fit,
                    const Eigen::VectorXd& fit_values) {
  Values out(fits.table.rows(), kUnknown);
  for (std::size_t i = 0; i < fit.rows.size(); ++i) {
    out[fit.rows[i]] = fit_values[static_cast<Eigen::Index>(i)];
  }
  return out;
}

/// A fit as a plot draws it.
struct Layer {
  const FitResult& fit;
  std::string kind;
  SvgPlot::Mark mark;
};

std::vector<Layer> layers_of(const PlottedFits& fits) {
  if (!fits.after) return {{fits.comparison.fit, "point", SvgPlot::Mark::kDot}};
  return {{fits.comparison.fit, "before", SvgPlot::Mark::kSquare},
          {*fits.after, "after", SvgPlot::Mark::kDot}};
}

/// Every so many-th row of the first fit: the same rows in all plots.
std::vector<std::size_t> plotted_rows(const PlottedFits& fits) {
  const std::vector<std::size_t>& rows = fits.comparison.fit.rows;
  const std::size_t stride = (rows.size() + kMostPoints - 1) / kMostPoints;
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < rows.size(); i += stride) out.push_back(rows[i]);
  return out;
}

Values values_of(const PlottedFits& fits, const Signals& signals, const std::string& variable) {
  Values out(fits.table.rows(), kUnknown);
  const double scale = variable == "time_s" ? 3600.0 : 1.0;
  const Signals::View values = signals.signal(variable);
  for (std::size_t i = 0; i < signals.rows(); ++i) {
    out[signals.table_row(i)] = values[static_cast<Eigen::Index>(i)] / scale;
  }
  return out;
}

/// What was cut into ranges, in the order of how badly its worst range fails.
std::vector<std::string> variables_of(const PlottedFits& fits, const Signals& signals) {
  std::vector<std::string> out;
  for (const Region& region : fits.comparison.regions) {
    if (region.variable.empty() || !signals.available(region.variable)) continue;
    if (std::find(out.begin(), out.end(), region.variable) == out.end()) {
      out.push_back(region.variable);
    }
  }
  return out;
}

std::string figure(const SvgPlot& plot, const std::string& caption = "") {
  const std::string svg = plot.svg();
  if (svg.empty()) return "";
  return "<figure>" + svg +
         (caption.empty() ? "" : "<figcaption>" + escaped(caption) + "</figcaption>") +
         "</figure>\n";
}

SvgPlot residual_plot(const PlottedFits& fits, const std::string& title,
                      const std::string& variable) {
  return {.title = title,
          .x_label = heading_of(variable),
          .y_label = "measured - model" + with_unit(config::unit_of(fits.model.observable)),
          .zero_line = true,
          .envelope = std::isfinite(fits.noise_floor) ? 2.0 * fits.noise_floor : 0.0};
}

/// Mean of the rows' values, leaving out what is missing.
double mean_of(const Values& values, const std::vector<std::size_t>& rows) {
  double sum = 0.0, count = 0.0;
  for (std::size_t row : rows) {
    if (std::isnan(values[row])) continue;
    sum += values[row];
    count += 1.0;
  }
  return count > 0.0 ? sum / count : kUnknown;
}

/// One polyline for the branch; it begins where the branch before it ended. A stop stands for
/// those of its rows that the other plots show.
SvgPlot::Series branch_series(const Branch& branch, const Branch* before, const Values& x,
                              const Values& y, const std::vector<std::size_t>& plotted) {
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

std::string symbol(std::string_view kind, std::string_view path, std::string_view words) {
  return fmt::format("<li class=\"{0}\"><svg viewBox=\"0 0 28 14\">{1}</svg>{2}</li>\n", kind, path,
                     words);
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
    const Values model = by_table_row(fits, layer.fit, layer.fit.predicted);
    const Values residual = by_table_row(fits, layer.fit, layer.fit.residual);
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
  const std::vector<const Region*> failing = failing_regions(fits.comparison);
  std::string out;
  for (const std::string& variable : variables_of(fits, signals)) {
    const double scale = variable == "time_s" ? 3600.0 : 1.0;
    SvgPlot plot = residual_plot(fits, "Residual by " + heading_of(variable), variable);
    const Values x = values_of(fits, signals, variable);
    for (const Layer& layer : layers_of(fits)) {
      const Values residual = by_table_row(fits, layer.fit, layer.fit.residual);
      SvgPlot::Series series{.kind = layer.kind, .mark = layer.mark};
      for (std::size_t row : plotted_rows(fits)) {
        series.points.emplace_back(x[row], residual[row]);
        series.rows.push_back(std::to_string(row));
      }
      plot.series.push_back(std::move(series));
    }
    std::string caption;
    for (std::size_t k = 0; k < failing.size(); ++k) {
      const Region& region = *failing[k];
      if (region.variable != variable) continue;
      plot.bands.push_back(
          {region.from / scale, region.to / scale, region.says, std::to_string(k + 1)});
      if (caption.empty()) caption = fmt::format("{}: {}", k + 1, region.says);
    }
    out += figure(plot, caption);
  }
  return out;
}

std::string loop_plots(const PlottedFits& fits) {
  const Signals signals(fits.table, fits.model.reference_temperature_c);
  std::vector<std::size_t> plotted = plotted_rows(fits);
  std::sort(plotted.begin(), plotted.end());
  std::string out;
  for (const char* variable : {"field_x_ut", "field_y_ut", "field_z_ut", "temperature_c"}) {
    if (!signals.available(variable)) continue;
    std::vector<Branch> branches = branches_of(signals, variable);
    if (branches.empty()) continue;
    const std::size_t passes = branches.size();
    branches.resize(std::min(passes, kMostBranches));
    SvgPlot plot = residual_plot(fits, "Loop over " + heading_of(variable), variable);
    const Values x = values_of(fits, signals, variable);
    for (const Layer& layer : layers_of(fits)) {
      const Values residual = by_table_row(fits, layer.fit, layer.fit.residual);
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

std::string plot_legend(const PlottedFits& fits) {
  std::string out = "<ul class=\"legend\">\n";
  if (fits.after) {
    out += symbol("before", R"(<path class="marks before" d="M11 4h7v7h-7z"/>)",
                  "before: the model as it came");
    out += symbol("after", R"(<path class="dots after" stroke-width="7" d="M14 7h0"/>)",
                  "after: with what was added");
  }
  if (fits.noise_floor > 0.0) {
    out += symbol("key", R"(<line class="noise" x1="0" y1="7" x2="28" y2="7"/>)",
                  "twice the noise that is left");
  }
  if (!failing_regions(fits.comparison).empty()) {
    out += symbol("key", R"(<rect class="band" width="28" height="14"/>)",
                  "the model fails by more than noise; numbered, worst first");
  }
  return out + "</ul>\n";
}

std::string loop_legend(const PlottedFits& fits) {
  const bool two = fits.after != nullptr;
  std::string out = "<ul class=\"legend\">\n";
  out += symbol(two ? "before" : "key",
                R"(<path class="joint rising" d="M0 7h28"/>)"
                R"(<path class="marks rising" d="M18 7l-8 -4v8z"/>)",
                two ? "rising, before" : "rising");
  out += symbol(two ? "before" : "key",
                R"(<path class="joint falling" d="M0 7h28"/>)"
                R"(<path class="marks falling" d="M10 7l8 -4v8z"/>)",
                two ? "falling, before" : "falling");
  if (two) {
    out += symbol("after", R"(<path class="joint after thin" d="M0 7h28"/>)",
                  "both, after: with what was added");
  }
  return out + "</ul>\n";
}

std::string rows_json(const PlottedFits& fits) {
  const Signals signals(fits.table, fits.model.reference_temperature_c);
  nlohmann::json names = {"row", "run", "segment"}, rows = nlohmann::json::object();
  std::vector<Values> columns;
  for (const std::string& variable : variables_of(fits, signals)) {
    names.push_back(heading_of(variable));
    columns.push_back(values_of(fits, signals, variable));
  }
  for (const Layer& layer : layers_of(fits)) {
    names.push_back((fits.after ? "residual " + layer.kind : "residual") +
                    with_unit(config::unit_of(fits.model.observable)));
    columns.push_back(by_table_row(fits, layer.fit, layer.fit.residual));
  }
  for (std::size_t row : plotted_rows(fits)) {
    nlohmann::json line = {row + 1, fits.table.run().at(row), fits.table.segment().at(row)};
    for (const Values& column : columns) line.push_back(number_text(column[row], ""));
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
