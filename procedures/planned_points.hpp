#pragma once
// What a plan will have measured at its end: how many points, as far as that can be known before.

#include <cstddef>

#include "procedures/plan.hpp"

namespace fogbench::procedures {

/// How many averages of that length end within a wait.
std::size_t windows_in(Seconds wait, Seconds window);

/// Points that the step gives when all goes well. Of one that waits for evidence, none: those that
/// come on the way are as many as it takes. Precondition: the step has its estimate.
std::size_t planned_points(const PlannedStep& step);
std::size_t planned_points(const Plan& plan);

/// Whether it records averages on the way to a temperature, as many as it takes.
bool is_open(const PlannedStep& step);

/// Whether the plan records points at all: a run of it that has none at its end has no result.
bool measures(const Plan& plan);

}  // namespace fogbench::procedures
