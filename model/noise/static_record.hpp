#pragma once
// A static record for the Allan deviation, taken out of a measurement table: samples of one run at
// a constant interval, without gaps.

#include <string>
#include <vector>

#include "config/result.hpp"
#include "model/table/table.hpp"

namespace fogbench::model {

struct StaticRecord {
  std::vector<double> rate_deg_per_h;
  double interval_s = 0.0;
};

/// The interval is the median step of time_s; where the table has no time_s, `interval_s`.
/// Errors: kBadInput: no such column, several runs, a missing value, a step that is more than 1 %
/// off (named by row), no interval at all.
Result<StaticRecord> static_record(const Table& table, const std::string& column = "rate_deg_per_h",
                                   double interval_s = 0.0);

}  // namespace fogbench::model
