#include "procedures/check_limits.hpp"
#include "procedures/estimate.hpp"
#include "procedures/plan.hpp"

namespace fogbench::procedures {

Result<Plan> make_plan(const std::string& name, std::vector<PlannedStep> steps,
                       const config::BenchConfig& bench) {
  estimate_durations(steps, bench);
  auto met = check_limits(name, steps, bench);
  if (!met) return met.error();
  Plan plan{name, std::move(steps), Seconds{0.0}, std::move(*met)};
  for (PlannedStep& step : plan.steps) {
    step.says = sentence(step);
    plan.estimate += step.estimate;
  }
  return plan;
}

}  // namespace fogbench::procedures
