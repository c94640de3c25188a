#pragma once

#include <vector>

#include "model/table/table.hpp"
#include "procedures/recorder.hpp"

namespace fogbench::acceptance {

/// Points as a measurement table: the channels of a point, `run` holds the test.
model::Table to_table(const std::vector<procedures::Point>& points);

}  // namespace fogbench::acceptance
