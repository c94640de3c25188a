#pragma once
// What a plan says and how long it will take, from simple figures of the bench file.

#include <vector>

#include "config/bench.hpp"
#include "procedures/plan.hpp"

namespace fogbench::procedures {

/// "set 50 uT along OX, settle for 5 s, average for 180 s as coil_x/up"
std::string sentence(const PlannedStep& step);

/// "2 h 40 min", "3 min 5 s", "45 s"
std::string duration_text(Seconds duration);

/// Fills `estimate` of every step. Temperatures change at the bench's constant heating and cooling
/// rates, starting from the room's.
void estimate_durations(std::vector<PlannedStep>& steps, const config::BenchConfig& bench);

}  // namespace fogbench::procedures
