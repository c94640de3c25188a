#pragma once
// How a table's stamps go on from row to row, within its runs.

#include <vector>

#include "model/table/table.hpp"

namespace fogbench::model {

struct TimeFall {
  std::size_t row = 0;  ///< the first behind it
  double from_s = 0.0, to_s = 0.0;
};

struct StepsOfTime {
  double usual_s = kMissing;  ///< the median of the steps that go forward
  std::size_t backwards = 0, first_backwards = 0;
  std::size_t repeated = 0, first_repeated = 0;
  std::size_t blank = 0;
  /// Falls behind most of what the run has covered so far: a logger or a counter began anew.
  std::vector<TimeFall> restarts;
  /// Longer than three usual steps, the longest first, at most ten; and how many there are.
  std::vector<TimeFall> gaps;
  std::size_t gap_count = 0;
};

/// Precondition: the table has time_s.
StepsOfTime steps_of_time(const Table& table);

}  // namespace fogbench::model
