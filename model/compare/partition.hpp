#pragma once
// Cuts the rows of a table into ranges of every variable it has: set points where the values
// cluster (a temperature list, a field sweep), quantiles where they spread; and by segment, sweep
// and run. Where a model fails is then said range by range.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "model/table/table.hpp"

namespace fogbench::model {

/// One range of a variable, or one text.
struct Range {
  std::string where;  ///< "segment coil_z/down", "run 2", or empty
  double from = 0.0, to = 0.0;
};

/// Rows by one variable.
struct Partition {
  std::string variable;  ///< column name; empty for texts
  std::vector<Range> ranges;
  std::vector<std::int16_t> index;  ///< into ranges, one per given row; -1: missing
};

/// Partitions with at least two ranges, over the given rows of the table. Columns: temperatures
/// and their rate (derived where there is none), gradient, ambient, heater, fields, azimuth, time.
/// At most 16 ranges each (40 texts). A few passes over the rows.
std::vector<Partition> partition_rows(const Table& table, std::span<const std::size_t> rows,
                                      double reference_temperature_c);

/// The ranges of one column's values: clusters when there are 2 to 16 tight ones, else up to 8
/// quantiles. Empty when fewer than two values differ.
std::vector<Range> ranges_of(std::span<const double> values);

/// "50..55 degC", "field z of 100 uT", "segment coil_z/down".
std::string place_name(const std::string& variable, const Range& range);

/// "At 50..55 degC", "At a field z of 100 uT", "In segment coil_z/down".
std::string place_in_words(const std::string& variable, const Range& range);

}  // namespace fogbench::model
