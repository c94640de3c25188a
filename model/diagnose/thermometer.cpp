#include "model/diagnose/thermometer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "config/units.hpp"
#include "model/diagnose/working_table.hpp"
#include "model/fit/fit.hpp"
#include "model/fit/predict.hpp"
#include "model/table/median.hpp"

namespace fogbench::model {
namespace {

/// Rows [begin, end) of one run with one reading.
struct Dwell {
  std::size_t begin, end;
  double reading;
};

std::vector<Dwell> dwells_of(std::span<const double> readings, const Signals::RunRange& run) {
  std::vector<Dwell> out;
  for (std::size_t i = run.begin; i < run.end; ++i) {
    if (std::isnan(readings[i])) continue;
    if (out.empty() || out.back().reading != readings[i]) out.push_back({i, i, readings[i]});
    out.back().end = i + 1;
  }
  return out;
}

struct Node {
  double time_s, value;
};

double value_at(const std::vector<Node>& nodes, double time_s) {
  const auto after = std::lower_bound(nodes.begin(), nodes.end(), time_s,
                                      [](const Node& node, double t) { return node.time_s < t; });
  if (after == nodes.begin()) return nodes.front().value;
  if (after == nodes.end()) return nodes.back().value;
  const Node &a = *std::prev(after), &b = *after;
  const double span = b.time_s - a.time_s;
  return span > 0.0 ? a.value + (b.value - a.value) * (time_s - a.time_s) / span : b.value;
}

/// A stretch of one reading, in a column that seldom repeats one, that ends with a jump.
std::vector<Dwell> stuck_stretches(std::span<const double> readings,
                                   const std::vector<Signals::RunRange>& runs) {
  constexpr std::size_t kFewestRows = 10;
  constexpr double kMostRepeats = 0.05, kJump = 8.0;  // of the usual step
  std::vector<Dwell> long_ones;
  std::vector<double> steps;
  std::size_t repeats = 0, others = 0;
  for (const Signals::RunRange& run : runs) {
    const std::vector<Dwell> dwells = dwells_of(readings, run);
    for (std::size_t i = 0; i < dwells.size(); ++i) {
      const std::size_t rows = dwells[i].end - dwells[i].begin;
      const bool inside = i > 0 && i + 1 < dwells.size();
      if (i > 0) steps.push_back(std::abs(dwells[i].reading - dwells[i - 1].reading));
      if (rows >= kFewestRows && inside) {
        long_ones.push_back(dwells[i]);
      } else {
        repeats += rows - 1;
        others += rows;
      }
    }
  }
  const bool fine = static_cast<double>(repeats) <= kMostRepeats * static_cast<double>(others);
  if (long_ones.empty() || steps.size() < kFewestRows || !fine) return {};
  const double usual = median(std::move(steps));
  std::erase_if(long_ones, [&](const Dwell& d) {
    return !(std::abs(readings[d.end] - d.reading) > kJump * usual);
  });
  return long_ones;
}

}  // namespace

double resolution_of(std::span<const double> readings) {
  constexpr std::array kSteps = {1.0, 0.5, 0.25, 0.2, 0.125, 0.1, 0.0625, 0.05};
  constexpr int kFewestSteps = 3;
  constexpr double kLeastShare = 0.3;  // of all changes are by one step: the step is used
  const double first = *std::min_element(readings.begin(), readings.end());
  if (!std::isfinite(first)) return 0.0;
  for (const double step : kSteps) {
    int one = 0, changes = 0;
    bool all = true;
    double before = kMissing;
    for (const double v : readings) {
      if (!std::isfinite(v)) continue;
      const double in_steps = v / step;
      all = std::abs(in_steps - std::round(in_steps)) < 1e-6 * std::max(1.0, std::abs(in_steps));
      if (!all) break;
      if (std::isfinite(before) && v != before) {
        ++changes;
        if (std::abs(v - before) < 1.5 * step) ++one;
      }
      before = v;
    }
    if (!all) continue;
    const bool used = one >= kFewestSteps && one >= kLeastShare * changes;
    return used ? step : 0.0;
  }
  return 0.0;
}

std::vector<double> through_the_steps(std::span<const double> readings,
                                      std::span<const double> time_s,
                                      const std::vector<Signals::RunRange>& runs,
                                      double resolution) {
  // A dwell this many times longer than the one beside it is a plateau, not part of a ramp.
  constexpr double kPlateau = 3.0;
  std::vector<double> out(readings.begin(), readings.end());
  for (const Signals::RunRange& run : runs) {
    const std::vector<Dwell> dwells = dwells_of(readings, run);
    if (dwells.size() < 2) continue;
    const auto length = [&](std::size_t i) {
      return static_cast<double>(dwells[i].end - dwells[i].begin);
    };
    std::vector<Node> nodes;
    for (std::size_t i = 0; i < dwells.size(); ++i) {
      const Dwell& d = dwells[i];
      const bool first = i == 0, last = i + 1 == dwells.size();
      const double start = time_s[d.begin], end = time_s[d.end - 1];
      double neighbour = length(i);
      if (!first) neighbour = std::min(neighbour, length(i - 1));
      if (!last) neighbour = std::min(neighbour, length(i + 1));
      const bool turns =
          !first && !last &&
          (dwells[i - 1].reading - d.reading) * (dwells[i + 1].reading - d.reading) > 0.0;
      const bool plateau = length(i) > kPlateau * neighbour;
      if (first || last || turns || plateau) {
        // From a neighbour's length inside the dwell on, its reading is all that is known.
        const double inside = plateau ? (end - start) * neighbour / length(i) : 0.5 * (end - start);
        if (!first && !last)
          nodes.push_back({start + std::min(inside, 0.5 * (end - start)), d.reading});
        if (first) nodes.push_back({end - inside, d.reading});
        if (last) nodes.push_back({start + inside, d.reading});
        if (!first && !last && plateau) nodes.push_back({end - inside, d.reading});
      }
      if (!last) {
        const Dwell& next = dwells[i + 1];
        const double half = 0.5 * (d.reading + next.reading);
        // A change of several steps is a jump of the temperature: nothing is known of its way.
        if (std::abs(next.reading - d.reading) < 1.5 * resolution) {
          nodes.push_back({0.5 * (end + time_s[next.begin]), half});
        } else {
          nodes.push_back({end, d.reading});
          nodes.push_back({time_s[next.begin], next.reading});
        }
      }
    }
    std::stable_sort(nodes.begin(), nodes.end(),
                     [](const Node& a, const Node& b) { return a.time_s < b.time_s; });
    for (std::size_t i = run.begin; i < run.end; ++i) {
      if (std::isnan(readings[i]) || std::isnan(time_s[i])) continue;
      out[i] = std::clamp(value_at(nodes, time_s[i]), readings[i] - 0.5 * resolution,
                          readings[i] + 0.5 * resolution);
    }
  }
  return out;
}

MendedTemperature mend_temperature(Table& table) {
  MendedTemperature out;
  if (!table.has("temperature_c") || !table.has("time_s")) return out;
  const auto given = table.column("temperature_c");
  std::vector<double> readings(given.begin(), given.end());
  const std::vector<Signals::RunRange> runs = Signals(table, 0.0).runs();
  for (const Dwell& stuck : stuck_stretches(readings, runs)) {
    out.notes.push_back(
        fmt::format("temperature_c stands at {:.6g} for {} rows and then jumps to {:.6g}: the "
                    "sensor stuck, and "
                    "a straight line is taken across.",
                    stuck.reading, stuck.end - stuck.begin, readings[stuck.end]));
    const double rise =
        (readings[stuck.end] - stuck.reading) / static_cast<double>(stuck.end - stuck.begin);
    for (std::size_t i = stuck.begin; i < stuck.end; ++i) {
      readings[i] += rise * static_cast<double>(i - stuck.begin);
    }
  }
  const double resolution = resolution_of(readings);
  if (resolution > 0.0) {
    out.resolution_c = resolution;
    out.readings_c = readings;
    readings = through_the_steps(readings, table.column("time_s"), runs, resolution);
    out.notes.push_back(fmt::format(
        "temperature_c is read in steps of {:g} degC: taken as the temperature that passes through "
        "the steps.",
        resolution));
  }
  if (!out.notes.empty()) table.set_column("temperature_c", std::move(readings));
  return out;
}

bool acts_through_temperature(const EffectInfo& info) {
  return !info.signals.empty() &&
         std::all_of(info.signals.begin(), info.signals.end(), [](std::string_view name) {
           return name == "temperature_c" || name == "temperature_rate_c_per_h" ||
                  name == "temperature_acceleration_c_per_h2" || name == "time_s";
         });
}

std::optional<double> lag_that_does_the_same(double rate_coefficient, double slope) {
  constexpr double kSlowest_s = 300.0;  // a sensor in a housing of its own
  const double lag_s = rate_coefficient / slope * config::kSecondsPerHour;
  return lag_s > 0.0 && lag_s <= kSlowest_s ? std::optional(lag_s) : std::nullopt;
}

std::optional<StepsError> StepsError::of(const Table& table, const FitResult& fit,
                                         double resolution_c) {
  constexpr double kRaised_c = 0.01;
  Table warmer = table;
  const auto given = table.column("temperature_c");
  std::vector<double> raised(given.begin(), given.end());
  for (double& t : raised) t += kRaised_c;
  warmer.set_column("temperature_c", std::move(raised));
  const auto at = predict(table, fit.fitted), above = predict(warmer, fit.fitted);
  if (!at || !above) return std::nullopt;
  const auto readings =
      table.column(table.has(kReadingsColumn) ? kReadingsColumn : "temperature_c");
  StepsError out{.resolution_c = resolution_c, .slope = {}, .readings_c = {}};
  for (const std::size_t row : fit.rows) {
    const auto i = static_cast<Eigen::Index>(row);
    out.slope.push_back(((*above)[i] - (*at)[i]) / kRaised_c);
    out.readings_c.push_back(readings[row]);
  }
  return out;
}

double StepsError::mean_slope() const {
  return std::accumulate(slope.begin(), slope.end(), 0.0) / static_cast<double>(slope.size());
}

double StepsError::of_one_step() const {
  double squares = 0.0;
  for (const double s : slope) squares += s * s;
  return resolution_c * std::sqrt(squares / static_cast<double>(slope.size()));
}

bool StepsError::explains(const Eigen::VectorXd& change, bool of_temperature) const {
  // A few rows may exceed it by noise; a change within the rows of one reading is another matter.
  constexpr double kMostBeyond = 0.05, kMostWithin = 0.25;
  const auto rows = static_cast<std::size_t>(change.size());
  if (rows != slope.size()) return false;
  const auto of = [&](std::size_t i) { return change[static_cast<Eigen::Index>(i)]; };
  const double mean_of_all = change.mean();
  std::size_t beyond = 0;
  double total = 0.0, within = 0.0;
  for (std::size_t i = 0; i < rows;) {
    std::size_t end = i;
    double mean = 0.0;
    for (; end < rows && readings_c[end] == readings_c[i]; ++end) mean += of(end);
    mean /= static_cast<double>(end - i);
    for (; i < end; ++i) {
      const double c = of(i) - mean_of_all;
      beyond += std::abs(c) > 0.5 * resolution_c * std::abs(slope[i]) ? 1 : 0;
      total += c * c;
      within += (of(i) - mean) * (of(i) - mean);
    }
  }
  return static_cast<double>(beyond) <= kMostBeyond * static_cast<double>(rows) &&
         (of_temperature || within <= kMostWithin * total);
}

void StepsError::widen(std::vector<Region>& regions) const {
  const double by = of_one_step() / std::sqrt(12.0);  // evenly spread over a step
  for (Region& r : regions) {
    if (!(r.standard_error > 0.0)) continue;
    const double wider = std::hypot(r.standard_error, by);
    r.z *= r.standard_error / wider;
    r.standard_error = wider;
    const double p =
        static_cast<double>(regions.size()) * std::erfc(std::abs(r.z) / std::sqrt(2.0));
    r.p_family_wise = std::min(1.0, std::max(r.p_family_wise, p));
  }
}

}  // namespace fogbench::model
