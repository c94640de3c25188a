#pragma once
// How long a plan will take, from simple figures of the bench file.

#include <vector>

#include "config/bench.hpp"
#include "procedures/plan.hpp"

namespace fogbench::procedures {

/// Fills `estimate` of every step. Temperatures change at the bench's constant heating and cooling
/// rates, starting from the room's.
void estimate_durations(std::vector<PlannedStep>& steps, const config::BenchConfig& bench);

}  // namespace fogbench::procedures
