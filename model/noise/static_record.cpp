#include "model/noise/static_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/table/median.hpp"

namespace fogbench::model {
namespace {

constexpr double kStepTolerance = 0.01;

}  // namespace

Result<StaticRecord> static_record(const Table& table, const std::string& column,
                                   double interval_s) {
  if (!table.has(column))
    return config::bad_input(fmt::format("the table has no column {}", column));
  const TextColumn& run = table.run();
  const std::span<const double> rate = table.column(column);
  for (std::size_t i = 0; i < rate.size(); ++i) {
    if (!std::isfinite(rate[i])) {
      return config::bad_input(
          fmt::format("row {}: {} is missing; a record without gaps was expected", i + 1, column));
    }
    if (run.index[i] != run.index[0]) {
      return config::bad_input(fmt::format("row {0}: {1} {2} after {1} {3}; one {1} was expected",
                                           i + 1, table.run_word(), run.at(i), run.at(0)));
    }
  }
  StaticRecord out{{rate.begin(), rate.end()}, interval_s};
  if (!table.has("time_s")) {
    if (!(interval_s > 0.0)) {
      return config::bad_input(
          "the table has no column time_s; the sampling interval was expected");
    }
    return out;
  }
  const std::span<const double> time = table.column("time_s");
  std::vector<double> steps;
  for (std::size_t i = 1; i < time.size(); ++i) steps.push_back(time[i] - time[i - 1]);
  if (steps.empty()) return config::bad_input("one row: a record was expected");
  out.interval_s = median(std::move(steps));
  for (std::size_t i = 1; i < time.size(); ++i) {
    const double step = time[i] - time[i - 1];
    if (!(std::abs(step - out.interval_s) <= kStepTolerance * out.interval_s)) {
      return config::bad_input(
          fmt::format("row {}: {:.6g} s after the row before; a constant {:.6g} s was "
                      "expected",
                      i + 1, step, out.interval_s));
    }
  }
  return out;
}

}  // namespace fogbench::model
