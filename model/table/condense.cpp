#include "model/table/condense.hpp"

#include <cmath>
#include <numeric>

#include "model/table/table.hpp"

namespace fogbench::model {

std::vector<RowGroup> neighbours(std::span<const std::uint32_t> run,
                                 std::span<const std::uint32_t> segment,
                                 std::span<const std::uint32_t> counts, std::size_t most) {
  const auto alike = [](std::span<const std::uint32_t> of, std::size_t i) {
    return of.empty() || of[i] == of[i - 1];
  };
  std::vector<RowGroup> groups;
  std::size_t rows = 0;  // of the source, in the last group
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (groups.empty() || rows + counts[i] > most || !alike(run, i) || !alike(segment, i)) {
      groups.push_back({i, i});
      rows = 0;
    }
    groups.back().end = i + 1;
    rows += counts[i];
  }
  return groups;
}

std::vector<double> condensed(std::string_view name, std::span<const double> values,
                              std::span<const std::uint32_t> counts,
                              std::span<const RowGroup> groups) {
  const bool error = name == "rate_std_error_deg_per_h", sum_up = name.ends_with("duration_s");
  std::vector<double> out;
  out.reserve(groups.size());
  for (const RowGroup& group : groups) {
    if (name == "temperature_start_c") {
      out.push_back(values[group.begin]);
      continue;
    }
    if (name == "temperature_end_c") {
      out.push_back(values[group.end - 1]);
      continue;
    }
    double sum = 0.0, weight = 0.0;
    for (std::size_t i = group.begin; i < group.end; ++i) {
      if (std::isnan(values[i])) continue;
      const double rows = counts.empty() ? 1.0 : counts[i];
      weight += rows;
      if (sum_up) {
        sum += values[i];
      } else {
        sum += error ? rows * rows * values[i] * values[i] : rows * values[i];
      }
    }
    if (!(weight > 0.0)) {
      out.push_back(kMissing);
    } else if (sum_up) {
      out.push_back(sum);
    } else {
      out.push_back((error ? std::sqrt(sum) : sum) / weight);
    }
  }
  return out;
}

std::vector<std::uint32_t> rows_of(std::span<const std::uint32_t> counts,
                                   std::span<const RowGroup> groups) {
  std::vector<std::uint32_t> out;
  out.reserve(groups.size());
  for (const RowGroup& group : groups) {
    out.push_back(std::accumulate(counts.begin() + static_cast<std::ptrdiff_t>(group.begin),
                                  counts.begin() + static_cast<std::ptrdiff_t>(group.end), 0U));
  }
  return out;
}

}  // namespace fogbench::model
