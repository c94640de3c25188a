#include "model/compare/partition.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "config/units.hpp"
#include "model/table/signals.hpp"

namespace fogbench::model {
namespace {

constexpr std::size_t kMostClusters = 16;
constexpr std::size_t kQuantiles = 8;
constexpr std::size_t kMostTexts = 40;
// With fewer rows a run's mean says nothing that its coefficients do not say better.
constexpr std::size_t kFewestPerRun = 5;
constexpr std::size_t kMostSampled = 100000;  // values looked at to place the ranges
// Clusters are told apart by gaps of this part of the variable's span, and no cluster may be wider
// than that part: 13 levels of a field sweep are 1/12 apart.
constexpr double kGap = 1.0 / 40.0;

struct Variable {
  const char* column;
  const char* article;
  const char* thing;  // before the range
  double least_span;  // below it the variable was not varied: what is left is its sensor's noise
};

constexpr Variable kVariables[] = {
    {"temperature_c", "", "", 0.5},
    {"temperature_rate_c_per_h", "a ", "temperature rate of ", 1.0},
    {"temperature_gradient_c", "a ", "temperature gradient of ", 0.1},
    {"ambient_c", "an ", "ambient temperature of ", 0.5},
    {"heater_w", "a ", "heater power of ", 0.1},
    {"field_x_ut", "a ", "field x of ", 5.0},
    {"field_y_ut", "a ", "field y of ", 5.0},
    {"field_z_ut", "a ", "field z of ", 5.0},
    {"azimuth_deg", "an ", "azimuth of ", 1.0},
    {"time_s", "a ", "time of ", 60.0},
};

/// Null: a variable that has no name for people.
const Variable* known_variable(const std::string& column) {
  for (const Variable& known : kVariables) {
    if (column == known.column) return &known;
  }
  return nullptr;
}

/// The range that holds the value: ranges are in order and do not overlap; values in a gap between
/// two go to the nearer one (rows that were not among those looked at).
std::int16_t range_of(const std::vector<Range>& ranges, double value) {
  if (!std::isfinite(value)) return -1;
  const auto above = std::lower_bound(ranges.begin(), ranges.end(), value,
                                      [](const Range& range, double v) { return range.to < v; });
  if (above == ranges.end()) return static_cast<std::int16_t>(ranges.size() - 1);
  const auto i = above - ranges.begin();
  const bool nearer_below =
      i > 0 && value < above->from && value - (above - 1)->to < above->from - value;
  return static_cast<std::int16_t>(nearer_below ? i - 1 : i);
}

/// One range for each text that `part` makes of the column's texts.
template <class Part>
Partition by_text(const TextColumn& column, std::span<const std::size_t> rows,
                  std::string_view kind, Part part) {
  Partition out;
  std::map<std::string, std::int16_t> known;
  std::vector<std::int16_t> of_value;
  for (const std::string& value : column.values) {
    const std::optional<std::string> text = part(value);
    if (!text || text->empty()) {
      of_value.push_back(-1);
      continue;
    }
    const auto [place, added] = known.emplace(*text, static_cast<std::int16_t>(out.ranges.size()));
    if (added) out.ranges.push_back({.where = fmt::format("{} {}", kind, *text)});
    of_value.push_back(place->second);
  }
  out.index.reserve(rows.size());
  for (std::size_t row : rows) out.index.push_back(of_value[column.index[row]]);
  return out;
}

std::vector<double> values_of(const Table& table, const Signals& signals, const char* column,
                              std::span<const std::size_t> rows) {
  std::vector<double> out;
  if (table.has(column)) {
    const std::span<const double> all = table.column(column);
    for (std::size_t row : rows) out.push_back(all[row]);
  } else if (signals.available(column)) {
    const auto derived = signals.signal(column);
    std::vector<double> by_row(table.rows());
    for (std::size_t i = 0; i < signals.rows(); ++i) {
      by_row[signals.table_row(i)] = derived[static_cast<Eigen::Index>(i)];
    }
    for (std::size_t row : rows) out.push_back(by_row[row]);
  }
  return out;
}

void keep(std::vector<Partition>& out, Partition partition) {
  if (partition.ranges.size() >= 2) out.push_back(std::move(partition));
}

}  // namespace

std::vector<Range> ranges_of(std::span<const double> values) {
  std::vector<double> sorted;
  const std::size_t stride = values.size() / kMostSampled + 1;
  for (std::size_t i = 0; i < values.size(); i += stride) {
    if (std::isfinite(values[i])) sorted.push_back(values[i]);
  }
  std::sort(sorted.begin(), sorted.end());
  if (sorted.empty() || sorted.front() == sorted.back()) return {};
  const double least = (sorted.back() - sorted.front()) * kGap;
  std::vector<Range> clusters{{.where = "", .from = sorted.front(), .to = sorted.front()}};
  bool tight = true;
  for (double value : sorted) {
    if (value - clusters.back().to > least) {
      if (clusters.size() == kMostClusters) tight = false;
      clusters.push_back({.where = "", .from = value, .to = value});
    }
    clusters.back().to = value;
    tight = tight && value - clusters.back().from <= least;
    if (!tight) break;
  }
  if (tight) return clusters;
  std::vector<Range> quantiles;
  const std::size_t parts = std::min(kQuantiles, sorted.size());
  for (std::size_t i = 0; i < parts; ++i) {
    const double from = sorted[i * sorted.size() / parts];
    const double to = sorted[(i + 1) * sorted.size() / parts - 1];
    if (!quantiles.empty() && from <= quantiles.back().to) {
      quantiles.back().to = std::max(quantiles.back().to, to);  // many equal values
    } else {
      quantiles.push_back({.where = "", .from = from, .to = to});
    }
  }
  return quantiles.size() >= 2 ? quantiles : std::vector<Range>{};
}

std::vector<Partition> partition_rows(const Table& table, std::span<const std::size_t> rows,
                                      double reference_temperature_c) {
  std::vector<Partition> out;
  const auto before_slash = [](const std::string& text) -> std::optional<std::string> {
    const std::size_t slash = text.find('/');
    if (slash == std::string::npos) return std::nullopt;
    return text.substr(0, slash);
  };
  const auto whole = [](const std::string& text) { return std::optional(text); };
  if (table.segment().values.size() <= kMostTexts) {
    keep(out, by_text(table.segment(), rows, "segment", whole));
    keep(out, by_text(table.segment(), rows, "sweep", before_slash));
  }
  const std::size_t runs = table.run().values.size();
  if (runs <= kMostTexts && rows.size() >= kFewestPerRun * runs) {
    keep(out, by_text(table.run(), rows, table.run_word(), whole));
  }
  const Signals signals(table, reference_temperature_c);
  for (const Variable& variable : kVariables) {
    const std::vector<double> values = values_of(table, signals, variable.column, rows);
    Partition partition{.variable = variable.column, .ranges = ranges_of(values), .index = {}};
    if (partition.ranges.empty()) continue;
    const double span = partition.ranges.back().to - partition.ranges.front().from;
    if (span < variable.least_span) continue;
    partition.index.reserve(values.size());
    for (double value : values) partition.index.push_back(range_of(partition.ranges, value));
    keep(out, std::move(partition));
  }
  return out;
}

std::string place_name(const std::string& variable, const Range& range) {
  if (variable.empty()) return range.where;
  const bool time = variable == "time_s";
  const double scale = time ? 3600.0 : 1.0;
  const double from = range.from / scale, to = range.to / scale;
  const std::string_view unit = time ? "h" : config::unit_of(variable);
  const Variable* known = known_variable(variable);
  const char* thing = known ? known->thing : "";
  // Set points are read with a little scatter: one number when four digits say the same.
  const std::string low = fmt::format("{:.4g}", from), high = fmt::format("{:.4g}", to);
  if (low == high || to - from <= 2e-3 * std::max(std::abs(from), std::abs(to))) {
    return fmt::format("{}{:.4g} {}", thing, 0.5 * (from + to), unit);
  }
  return fmt::format("{}{}..{} {}", thing, low, high, unit);
}

std::string place_in_words(const std::string& variable, const Range& range) {
  const Variable* known = known_variable(variable);
  return fmt::format("{} {}{}", variable.empty() ? "In" : "At", known ? known->article : "",
                     place_name(variable, range));
}

}  // namespace fogbench::model
