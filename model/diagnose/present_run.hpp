#pragma once
// The run that there is already, seen as one of the experiments that could be done again.

#include <optional>

#include "model/next/experiments.hpp"

namespace fogbench::model {

/// The table with its windows; rows without a time or a duration follow each other evenly.
Recorded recorded_from(const Table& present);
/// As the present bench would record it: the columns that the present table has, and whatever else
/// it has (a user's own signal) at its mean.
Recorded as_recorded(const Recorded& record, const Table& present);
BenchState state_of(const Table& present);
/// The present run, and the first point of it once more at its end; nothing where that would mean
/// hours of cooling, or where there are several runs.
std::optional<Recorded> first_point_again(const Recorded& present);
/// Time that was recorded, gaps included.
double span_h(const Recorded& record);

}  // namespace fogbench::model
