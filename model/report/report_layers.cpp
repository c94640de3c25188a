#include "model/report/report_layers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "config/units.hpp"
#include "model/report/report_page.hpp"

namespace fogbench::model {
namespace {

constexpr std::size_t kMostPoints = 2000;

}  // namespace

std::vector<Layer> layers_of(const PlottedFits& fits) {
  if (!fits.after) return {{fits.comparison.fit, "point", SvgPlot::Mark::kDot}};
  return {{fits.comparison.fit, "before", SvgPlot::Mark::kSquare},
          {*fits.after, "after", SvgPlot::Mark::kDot}};
}

RowValues by_table_row(const PlottedFits& fits, const FitResult& fit,
                       const Eigen::VectorXd& values) {
  RowValues out(fits.table.rows(), kMissing);
  for (std::size_t i = 0; i < fit.rows.size(); ++i) {
    out[fit.rows[i]] = values[static_cast<Eigen::Index>(i)];
  }
  return out;
}

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

std::vector<std::size_t> plotted_rows(const PlottedFits& fits) {
  const std::vector<std::size_t>& rows = fits.comparison.fit.rows;
  const std::size_t stride = (rows.size() + kMostPoints - 1) / kMostPoints;
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < rows.size(); i += stride) out.push_back(rows[i]);
  std::sort(out.begin(), out.end());
  return out;
}

SvgPlot residual_axes(const PlottedFits& fits, const std::string& title,
                      const std::string& variable) {
  return {.title = title,
          .x_label = heading_of(variable),
          .y_label = "measured - model" + with_unit(config::unit_of(fits.model.observable)),
          .zero_line = true,
          .envelope = std::isfinite(fits.noise_floor) ? 2.0 * fits.noise_floor : 0.0};
}

std::string figure(const SvgPlot& plot, const std::string& caption) {
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

std::string legend_entry(std::string_view kind, std::string_view picture, std::string_view words) {
  return fmt::format("<li class=\"{}\"><svg viewBox=\"0 0 28 14\">{}</svg>{}</li>\n", kind, picture,
                     words);
}

}  // namespace fogbench::model
