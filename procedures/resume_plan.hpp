#pragma once
// The plan with which an interrupted procedure goes on: what brings gyro and bench back to where
// they were, then the steps that are left, from the one that was interrupted.
//
//   left      from the interrupted step; from the first one of its indivisible block, because the
//             field's history matters; from the first one of its heating (targets, settling, waits
//             in a row), because a rise that was interrupted is no rise; a ramp begins one
//   redone    before them and without recording anything: the heating that led to the temperature
//   of
//             that moment, its soak included; the gyro's warm-up, because nobody knows how long it
//             was without power; the last turn and the nulling of the ambient field after it; the
//             wait right before the first step that is left
//
// Prompts, averages and sweeps that were done are not repeated.

#include <cstddef>

#include "config/bench.hpp"
#include "config/result.hpp"
#include "procedures/plan.hpp"

namespace fogbench::procedures {

/// Before the path of a step that is redone, in the record.
inline constexpr auto kRedone = "again ";

struct ResumePlan {
  Plan plan;
  std::size_t first = 0;   ///< index in the whole plan of the first step that is left
  std::size_t redone = 0;  ///< how many steps of `plan` come before it
};

/// Where a run that was interrupted at step `at` (an index, at most the number of steps) goes on.
std::size_t first_step_left(const Plan& whole, std::size_t at);

/// Errors: kLimit, as make_plan.
Result<ResumePlan> resume_plan(const Plan& whole, std::size_t at, const config::BenchConfig& bench);

}  // namespace fogbench::procedures
