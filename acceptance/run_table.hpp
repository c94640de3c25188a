#pragma once

#include <vector>

#include "model/table/table.hpp"
#include "procedures/recorder.hpp"

namespace fogbench::acceptance {

/// Points as a measurement table: the numbers of point_columns(), `run` holds the test.
model::Table to_table(const std::vector<procedures::Point>& points);

}  // namespace fogbench::acceptance
