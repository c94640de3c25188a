#pragma once
// Raw samples made into averages of a fixed length.

#include "config/result.hpp"
#include "model/table/table.hpp"

namespace fogbench::model {

/// Rows of one run and segment within windows of `seconds` from its first row become one each: the
/// mean of every column; durations are summed (or made, from the usual step), and
/// rate_std_error_deg_per_h is the scatter of the rates in the window over the root of their number
/// where the table has no standard errors of its own. Errors: kBadInput for a table without time_s,
/// for one whose rows are not in the order of time, and for windows shorter than two usual steps.
Result<Table> average_rows(const Table& table, double seconds);

}  // namespace fogbench::model
