#include "model/report/report_plots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "config/units.hpp"
#include "model/report/report_layers.hpp"
#include "model/report/report_page.hpp"

namespace fogbench::model {
namespace {

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

std::string rows_json(const PlottedFits& fits) {
  const Signals signals(fits.table, fits.model.reference_temperature_c);
  nlohmann::json names = {"row", "run", "segment"}, rows = nlohmann::json::object();
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
