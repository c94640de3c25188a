#include "model/table/inspection.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "config/column_unit.hpp"
#include "config/units.hpp"

namespace fogbench::model {
namespace {

/// Values that a resolution is looked for in.
constexpr std::size_t kValuesForResolution = 20'000;
/// A column that changes from row to row less often has a reason to stand still.
constexpr double kMovesAlways = 0.5;
/// So many equal rows are then no chance.
constexpr std::size_t kStandsStill = 10;
/// The end of a range is reached for shorter.
constexpr std::size_t kAtTheEnd = 5;

std::optional<double> smallest_step(std::span<const double> values) {
  std::vector<double> some;
  const std::size_t every = values.size() / kValuesForResolution + 1;
  for (std::size_t i = 0; i < values.size(); i += every) {
    if (!std::isnan(values[i])) some.push_back(values[i]);
  }
  std::sort(some.begin(), some.end());
  some.erase(std::unique(some.begin(), some.end()), some.end());
  if (some.size() < 3) return {};
  const double largest = std::max(std::abs(some.front()), std::abs(some.back()));
  const double rounding = 1e-12 * largest;
  double step = some.back() - some.front();
  for (std::size_t i = 1; i < some.size(); ++i) {
    const double difference = some[i] - some[i - 1];
    if (difference > 10.0 * rounding) step = std::min(step, difference);
  }
  constexpr double kNear = 0.05;
  std::size_t off = 0;
  for (std::size_t i = 1; i < some.size(); ++i) {
    const double steps = (some[i] - some[i - 1]) / step;
    off += std::abs(steps - std::round(steps)) > kNear ? 1 : 0;
  }
  // Of values that are as fine as the differences between them nothing can be said.
  const bool fine = step < 1e-6 * (some.back() - some.front());
  if (fine || 100 * off > some.size()) return {};
  return step;
}

void find_still(std::span<const double> values, ColumnInspection& out) {
  std::size_t changes = 0, pairs = 0;
  Stretch now, longest, at_end;
  const auto conclude = [&] {
    const bool extreme = now.value == out.least || now.value == out.most;
    Stretch& best = extreme ? at_end : longest;
    if (now.rows > best.rows) best = now;
  };
  for (std::size_t row = 0; row < values.size(); ++row) {
    if (now.rows > 0 && values[row] == now.value) {
      ++now.rows;
      ++pairs;
      continue;
    }
    if (now.rows > 0) conclude();
    const bool counts = row > 0 && !std::isnan(values[row]) && !std::isnan(values[row - 1]);
    changes += counts ? 1 : 0;
    pairs += counts ? 1 : 0;
    now = std::isnan(values[row]) ? Stretch{} : Stretch{row, 1, values[row]};
  }
  if (now.rows > 0) conclude();
  // Rows of a stretch do not count against the column's moving.
  const double moving = static_cast<double>(pairs - std::min(pairs, longest.rows + at_end.rows));
  if (!(static_cast<double>(changes) > kMovesAlways * moving) || changes < kStandsStill) return;
  if (longest.rows >= kStandsStill) out.stuck = longest;
  if (at_end.rows >= kAtTheEnd) out.saturated = at_end;
}

ColumnInspection inspect_column(const Table& table, const std::string& name) {
  ColumnInspection out{.name = name, .unit = std::string(config::unit_of(name))};
  if (out.unit.empty()) {
    const auto stated = config::unit_in_name(name);
    if (stated && *stated != nullptr) out.unit = (*stated)->name;
  }
  const auto values = table.column(name);
  double sum = 0.0;
  for (const double value : values) {
    if (std::isnan(value)) {
      ++out.missing;
      continue;
    }
    ++out.values;
    sum += value;
    out.least = std::isnan(out.least) ? value : std::min(out.least, value);
    out.most = std::isnan(out.most) ? value : std::max(out.most, value);
  }
  if (out.values > 0) out.mean = sum / static_cast<double>(out.values);
  out.resolution = smallest_step(values);
  find_still(values, out);
  return out;
}

}  // namespace

Inspection inspect(const Table& table) {
  Inspection out{.rows = table.rows(), .runs = table.run().values};
  for (const std::string& segment : table.segment().values) {
    if (!segment.empty()) out.segments.push_back(segment);
  }
  for (const std::string& name : table.column_names()) {
    out.columns.push_back(inspect_column(table, name));
  }
  if (table.has("time_s")) {
    out.time = steps_of_time(table);
    const auto time = table.column("time_s");
    for (const double t : time) {
      if (std::isnan(t)) continue;
      if (std::isnan(out.first_s)) out.first_s = t;
      out.last_s = t;
    }
  }
  return out;
}

}  // namespace fogbench::model
