#pragma once
// How long a plan will take, from simple figures of the bench file.

#include <vector>

#include "config/bench.hpp"
#include "procedures/plan.hpp"

namespace fogbench::procedures {

/// Fills `estimate` of every step, and where its ramps start. Temperatures start from the room's;
/// but for ramps, which say their rate, they change at the bench's constant heating and cooling
/// rates.
void estimate_durations(std::vector<PlannedStep>& steps, const config::BenchConfig& bench);

}  // namespace fogbench::procedures
