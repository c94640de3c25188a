#pragma once
// What a step and a duration are called on the screen.

#include <string>

#include "procedures/plan.hpp"

namespace fogbench::procedures {

/// "set 50 uT along OX, settle for 5 s, average for 180 s as coil_x/up"
std::string sentence(const PlannedStep& step);

/// "2 h 40 min", "3 min 5 s", "45 s"
std::string duration_text(Seconds duration);

/// "along OX", "along north"
std::string along_text(Axis axis);
/// " and 200 uT north" of what the other pair holds meanwhile; empty for nothing.
std::string across_text(const SweepLevel& level);

}  // namespace fogbench::procedures
