#pragma once
// What a table holds, before anybody fits anything to it: how its time goes on, in which steps each
// column moves, where it stands still.

#include <optional>
#include <string>
#include <vector>

#include "model/table/steps_of_time.hpp"
#include "model/table/table.hpp"

namespace fogbench::model {

/// Rows [row, row + rows) of equal values.
struct Stretch {
  std::size_t row = 0, rows = 0;
  double value = 0.0;
};

struct ColumnInspection {
  std::string name;
  std::string unit;  ///< empty: nobody says
  std::size_t values = 0, missing = 0;
  double least = kMissing, most = kMissing, mean = kMissing;
  /// What all its values are a multiple of, near enough; none where they are too fine to see it.
  std::optional<double> resolution;
  /// Of a column that moves nearly always: where it stands still at its least or most value, as
  /// a sensor at the end of its range, or elsewhere, as one that hangs. The longest.
  std::optional<Stretch> saturated, stuck;
};

struct Inspection {
  std::size_t rows = 0;
  std::vector<std::string> runs, segments;
  std::optional<StepsOfTime> time;
  double first_s = kMissing, last_s = kMissing;
  std::vector<ColumnInspection> columns;
};

Inspection inspect(const Table& table);

}  // namespace fogbench::model
