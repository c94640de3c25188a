#include "model/table/join_tables.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "model/table/steps_of_time.hpp"

namespace fogbench::model {
namespace {

Error cannot_join(const std::string& name, std::string_view what) {
  return {ErrorCode::kBadInput, fmt::format("{}: {}", name, what)};
}

std::pair<double, double> covered(const Table& table) {
  std::pair<double, double> out{kMissing, kMissing};
  for (const double t : table.column("time_s")) {
    if (std::isnan(t)) continue;
    out.first = std::isnan(out.first) ? t : std::min(out.first, t);
    out.second = std::isnan(out.second) ? t : std::max(out.second, t);
  }
  return out;
}

/// A table's rows with a stamp, in the order of time.
std::vector<std::size_t> rows_by_time(std::span<const double> time) {
  std::vector<std::size_t> rows(time.size());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  std::erase_if(rows, [&](std::size_t row) { return std::isnan(time[row]); });
  std::stable_sort(rows.begin(), rows.end(),
                   [&](std::size_t a, std::size_t b) { return time[a] < time[b]; });
  return rows;
}

/// Of each row of `base` the nearest of `other`; none is its number of rows.
std::vector<std::size_t> nearest_rows(const Table& base, const Table& other, double tolerance_s) {
  const auto time = base.column("time_s"), others = other.column("time_s");
  const std::vector<std::size_t> rows = rows_by_time(others);
  std::vector<std::size_t> out(base.rows(), other.rows());
  for (std::size_t row = 0; row < out.size(); ++row) {
    if (std::isnan(time[row])) continue;
    const auto after = std::lower_bound(rows.begin(), rows.end(), time[row],
                                        [&](std::size_t r, double t) { return others[r] < t; });
    double nearest = tolerance_s;
    for (const auto at : {after, after == rows.begin() ? after : std::prev(after)}) {
      if (at == rows.end()) continue;
      const double off = std::abs(others[*at] - time[row]);
      if (off > nearest) continue;
      nearest = off;
      out[row] = *at;
    }
  }
  return out;
}

}  // namespace

Result<Joined> join_tables(std::vector<Table> tables, const std::vector<std::string>& names,
                           double tolerance_s) {
  Joined out{std::move(tables.front()), {}};
  if (tables.size() == 1) return out;
  for (std::size_t i = 1; i < tables.size(); ++i) {
    const Table& other = tables[i];
    if (!out.table.has("time_s")) {
      return cannot_join(names.front(), out.table.why_missing("time_s"));
    }
    if (!other.has("time_s")) return cannot_join(names[i], other.why_missing("time_s"));
    if (other.run().values.size() > 1) {
      return cannot_join(names[i], fmt::format("found the runs {}, expected one to join",
                                               fmt::join(other.run().values, ", ")));
    }
    const auto [first, last] = covered(out.table);
    const auto [its_first, its_last] = covered(other);
    if (out.table.column_names() == other.column_names()) {
      if (!(its_first > last)) {
        return cannot_join(names[i],
                           fmt::format("begins at {:.10g} s, expected it after the end of "
                                       "the one before it, {:.10g} s: name the files in "
                                       "the order of time",
                                       its_first, last));
      }
      out.table.append(other);
      out.says.push_back(
          fmt::format("{}: {} rows go on after {:.10g} s", names[i], other.rows(), last));
      continue;
    }
    const double step = steps_of_time(out.table).usual_s, its_step = steps_of_time(other).usual_s;
    const double within = std::isnan(tolerance_s) ? 0.5 * std::fmax(step, its_step) : tolerance_s;
    const std::vector<std::size_t> from = nearest_rows(out.table, other, within);
    const auto found = static_cast<std::size_t>(std::count_if(
        from.begin(), from.end(), [&](std::size_t row) { return row < other.rows(); }));
    if (found == 0) {
      return cannot_join(
          names[i],
          fmt::format("no row is within {:.4g} s of one of {}: it covers {:.10g} to {:.10g} "
                      "s, the other {:.10g} to {:.10g} s",
                      within, names.front(), its_first, its_last, first, last));
    }
    std::vector<std::string> added, left_out;
    for (const std::string& name : other.column_names()) {
      if (name == "time_s") continue;
      if (out.table.has(name)) {
        left_out.push_back(name);
        continue;
      }
      const auto values = other.column(name);
      std::vector<double> joined(out.table.rows(), kMissing);
      for (std::size_t row = 0; row < joined.size(); ++row) {
        if (from[row] < other.rows()) joined[row] = values[from[row]];
      }
      out.table.set_column(name, std::move(joined));
      added.push_back(name);
    }
    for (const std::string& line : other.provenance()) out.table.add_provenance(line);
    out.says.push_back(fmt::format("{}: {} joined to {} of {} rows, within {:.4g} s{}", names[i],
                                   fmt::join(added, ", "), found, out.table.rows(), within,
                                   left_out.empty() ? ""
                                                    : fmt::format("; {} left out, which the first "
                                                                  "file has",
                                                                  fmt::join(left_out, ", "))));
  }
  return out;
}

}  // namespace fogbench::model
