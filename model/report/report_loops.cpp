#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "model/compare/loops.hpp"
#include "model/report/report_layers.hpp"
#include "model/report/report_page.hpp"

namespace fogbench::model {
namespace {

constexpr std::size_t kMostBranches = 24;

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

}  // namespace fogbench::model
