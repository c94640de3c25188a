#include "model/table/average_rows.hpp"

#include <fmt/format.h>

#include <cmath>

#include "model/table/condense.hpp"
#include "model/table/steps_of_time.hpp"

namespace fogbench::model {
namespace {

std::vector<RowGroup> windows_of(const Table& table, double seconds) {
  const auto time = table.column("time_s");
  const auto &run = table.run().index, &segment = table.segment().index;
  std::vector<RowGroup> groups;
  double window = 0.0, first = 0.0;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (std::isnan(time[row])) continue;
    const bool anew =
        groups.empty() || run[row] != run[row - 1] || segment[row] != segment[row - 1];
    if (anew) first = time[row];
    // Stamps are rounded: one that should begin a window may lie a little before it.
    const double its = std::floor((time[row] - first) / seconds * (1.0 + 1e-9) + 1e-9);
    if (anew || its != window) groups.push_back({row, row});
    window = its;
    groups.back().end = row + 1;
  }
  return groups;
}

/// Scatter over sqrt(n).
std::vector<double> standard_errors(std::span<const double> values,
                                    std::span<const RowGroup> groups) {
  std::vector<double> out;
  for (const RowGroup& group : groups) {
    double count = 0.0, mean = 0.0, squares = 0.0;  // Welford
    for (std::size_t i = group.begin; i < group.end; ++i) {
      if (std::isnan(values[i])) continue;
      count += 1.0;
      const double off = values[i] - mean;
      mean += off / count;
      squares += off * (values[i] - mean);
    }
    out.push_back(count > 1.0 ? std::sqrt(squares / (count - 1.0) / count) : kMissing);
  }
  return out;
}

}  // namespace

Result<Table> average_rows(const Table& table, double seconds) {
  const auto bad = [](std::string what) { return Error{ErrorCode::kBadInput, std::move(what)}; };
  if (!table.has("time_s")) return bad(table.why_missing("time_s"));
  const StepsOfTime steps = steps_of_time(table);
  if (steps.backwards > 0) {
    return bad(fmt::format("time_s runs backwards at row {}, expected rows in the order of time",
                           steps.first_backwards + 1));
  }
  if (!(seconds >= 2.0 * steps.usual_s)) {
    return bad(
        fmt::format("rows are {:.4g} s apart, expected averages of two rows at least, not {:g} s",
                    steps.usual_s, seconds));
  }
  const std::vector<RowGroup> groups = windows_of(table, seconds);
  Table out;
  for (const std::string& name : table.column_names()) {
    out.set_column(name, condensed(name, table.column(name), {}, groups));
  }
  constexpr auto kError = "rate_std_error_deg_per_h";
  if (table.has("rate_deg_per_h") && !table.has(kError)) {
    out.set_column(kError, standard_errors(table.column("rate_deg_per_h"), groups));
  }
  if (!table.has("duration_s")) {
    std::vector<double> durations;
    for (const RowGroup& group : groups) {
      durations.push_back(static_cast<double>(group.end - group.begin) * steps.usual_s);
    }
    out.set_column("duration_s", std::move(durations));
  }
  const auto kept = [&](const TextColumn& column) {
    TextColumn first{column.values, {}};
    for (const RowGroup& group : groups) first.index.push_back(column.index[group.begin]);
    return first;
  };
  out.set_run(kept(table.run()));
  out.set_run_word(table.run_word());
  out.set_segment(kept(table.segment()));
  for (const std::string& line : table.provenance()) out.add_provenance(line);
  out.add_provenance(fmt::format("{} rows averaged over {:g} s each", table.rows(), seconds));
  return out;
}

}  // namespace fogbench::model
