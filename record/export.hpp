#pragma once
// A run as CSV and as a measurement table. Nothing here depends on when, where or by whom the run
// was made: two runs from one seed give the same bytes.

#include <cstdint>

#include "config/output_file.hpp"
#include "config/result.hpp"
#include "record/run_log_reader.hpp"

namespace fogbench::record {

/// The valid points of a run and of those that it takes up, in time order. kBadInput for a run that
/// was not completed, unless `unfinished` allows it, and for a run without points.
Result<std::vector<procedures::Point>> valid_points(RunLogReader& reader, std::int64_t run,
                                                    bool unfinished);

/// Columns of the measurement table, then what else the points have.
/// Numbers have the fewest digits that read back the same; missing ones are empty.
Status write_points(const std::vector<procedures::Point>& points, config::OutputFile& out);

/// The raw stream, one row a frame: time_s, rate_deg_per_h (reference rate subtracted),
/// temperature_c.
Status write_gyro(RunLogReader& reader, const StoredRun& run, config::OutputFile& out);

}  // namespace fogbench::record
