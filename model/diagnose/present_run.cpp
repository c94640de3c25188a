#include "model/diagnose/present_run.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "model/table/moving_signals.hpp"
#include "model/table/signals.hpp"

namespace fogbench::model {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kHeld_c = 2.0;     // a temperature that moves by less was held
constexpr double kWindow_s = 60.0;  // of rows without a time

double mean_of(std::span<const double> values, double otherwise) {
  double sum = 0.0, count = 0.0;
  for (const double v : values) {
    if (!std::isfinite(v)) continue;
    sum += v;
    count += 1.0;
  }
  return count > 0.0 ? sum / count : otherwise;
}

}  // namespace

Recorded recorded_from(const Table& present) {
  Recorded out{.table = present, .windows = {}, .hours = 0.0};
  const std::size_t rows = present.rows();
  Windows& w = out.windows;
  for (std::size_t i = 0; i < rows; ++i) {
    if (i == 0 || present.run().index[i] != present.run().index[i - 1]) w.run_begin.push_back(i);
  }
  w.run_begin.push_back(rows);
  const auto n = static_cast<Index>(rows);
  w.centre_s.resize(n);
  w.duration_s = VectorXd::Constant(n, kWindow_s);
  w.white_floor = VectorXd::Zero(n);
  for (std::size_t run = 0; run + 1 < w.run_begin.size(); ++run) {
    for (std::size_t i = w.run_begin[run]; i < w.run_begin[run + 1]; ++i) {
      const auto k = static_cast<Index>(i);
      const double counted = kWindow_s * static_cast<double>(i - w.run_begin[run]);
      w.centre_s[k] = present.has("time_s") ? present.column("time_s")[i] : counted;
      if (present.has("time_s") && present.has("duration_s")) {
        w.duration_s[k] = present.column("duration_s")[i];
      }
    }
    const auto first = static_cast<Index>(w.run_begin[run]);
    const auto last = static_cast<Index>(w.run_begin[run + 1]) - 1;
    // A window that reaches into its neighbour, or has no length, is cut at the middle.
    for (Index k = first; k <= last; ++k) {
      double gap = std::numeric_limits<double>::infinity();
      if (k > first) gap = std::min(gap, w.centre_s[k] - w.centre_s[k - 1]);
      if (k < last) gap = std::min(gap, w.centre_s[k + 1] - w.centre_s[k]);
      if (!(w.duration_s[k] > 0.0) || w.duration_s[k] > gap) {
        w.duration_s[k] = std::isfinite(gap) ? 0.999 * gap : kWindow_s;
      }
    }
    // From power-on, where time_s begins; but no clock of another kind (seconds since 1970).
    constexpr double kLongestWarmUp_s = 86400.0;
    const double start_s = w.centre_s[first] - 0.5 * w.duration_s[first];
    const bool from_power_on = start_s > 0.0 && start_s < kLongestWarmUp_s;
    out.hours +=
        (w.centre_s[last] + 0.5 * w.duration_s[last] - (from_power_on ? 0.0 : start_s)) / 3600.0;
  }
  return out;
}

Recorded as_recorded(const Recorded& record, const Table& present) {
  Recorded out{.table = {}, .windows = record.windows, .hours = record.hours};
  for (const std::string& name : present.column_names()) {
    if (record.table.has(name)) {
      const auto values = record.table.column(name);
      out.table.set_column(name, {values.begin(), values.end()});
    } else {
      out.table.set_column(
          name, std::vector<double>(record.table.rows(), mean_of(present.column(name), 0.0)));
    }
  }
  out.table.set_segment(record.table.segment());
  return out;
}

BenchState state_of(const Table& present) {
  BenchState state;
  if (present.has("ambient_c")) {
    state.ambient_c = mean_of(present.column("ambient_c"), state.ambient_c);
  }
  state.held_c = state.ambient_c;
  if (present.has("temperature_c")) {
    const auto values = present.column("temperature_c");
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    const double mean = mean_of(values, state.ambient_c);
    if (*high - *low < kHeld_c && mean > state.ambient_c + kHeld_c) state.held_c = mean;
  }
  for (const auto& [name, axis] : kFieldSignals) {
    const std::string column(name);
    if (!present.has(column)) continue;
    const auto values = present.column(column);
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    if (*high - *low > least_excitation(column)) state.moving_axes += axis;
  }
  return state;
}

std::optional<Recorded> first_point_again(const Recorded& present) {
  if (present.windows.run_begin.size() != 2 || !present.table.has("time_s")) return std::nullopt;
  if (present.table.has("temperature_c")) {
    // Returning to it must not take hours of cooling.
    const auto t = present.table.column("temperature_c");
    if (std::abs(t.back() - t.front()) > kHeld_c) return std::nullopt;
  }
  constexpr int kWindows = 3;
  const Table& table = present.table;
  std::vector<bool> first(table.rows(), false);
  first[0] = true;
  Recorded out = present;
  const Index n = present.windows.rows();
  const double duration = present.windows.duration_s[0];
  const double end = present.windows.centre_s[n - 1] + 0.5 * present.windows.duration_s[n - 1];
  out.windows.centre_s.conservativeResize(n + kWindows);
  out.windows.duration_s.conservativeResize(n + kWindows);
  out.windows.white_floor = VectorXd::Zero(n + kWindows);
  out.windows.run_begin.back() += kWindows;
  for (int i = 0; i < kWindows; ++i) {
    Table row = table.select(first);
    const double centre = end + duration * (i + 1.0);
    row.set_column("time_s", {centre});
    out.table.append(row);
    out.windows.centre_s[n + i] = centre;
    out.windows.duration_s[n + i] = duration;
  }
  out.hours += duration * (kWindows + 0.5) / 3600.0;
  return out;
}

double span_h(const Recorded& record) {
  const Windows& w = record.windows;
  double span_s = 0.0;
  for (std::size_t run = 0; run + 1 < w.run_begin.size(); ++run) {
    span_s += w.centre_s[static_cast<Index>(w.run_begin[run + 1]) - 1] -
              w.centre_s[static_cast<Index>(w.run_begin[run])];
  }
  return span_s / 3600.0;
}

}  // namespace fogbench::model
