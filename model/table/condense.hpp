#pragma once
// Neighbouring rows of a table averaged into one.

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace fogbench::model {

/// Rows [begin, end).
struct RowGroup {
  std::size_t begin, end;
};

/// Neighbours of one run and segment, as many as stand for at most `most` rows of the source; a row
/// that stands for more is alone. `run` and `segment` may be empty (all alike); counts[i]: how many
/// rows of the source row i stands for.
std::vector<RowGroup> neighbours(std::span<const std::uint32_t> run,
                                 std::span<const std::uint32_t> segment,
                                 std::span<const std::uint32_t> counts, std::size_t most);

/// Of the column `name`, one number a group, missing ones left out: the mean, weighted with
/// `counts` (empty: all alike); durations are summed, standard errors become that of the mean, the
/// temperatures at a window's ends are those of its first and last row.
std::vector<double> condensed(std::string_view name, std::span<const double> values,
                              std::span<const std::uint32_t> counts,
                              std::span<const RowGroup> groups);

/// How many rows of the source each group stands for.
std::vector<std::uint32_t> rows_of(std::span<const std::uint32_t> counts,
                                   std::span<const RowGroup> groups);

}  // namespace fogbench::model
