#include "procedures/plan.hpp"

#include "config/paths.hpp"
#include "procedures/check_limits.hpp"
#include "procedures/estimate.hpp"
#include "procedures/expand.hpp"

namespace fogbench::procedures {
namespace {

/// A procedure beside the caller's file goes before a ready one of that name.
Result<config::ProcedureConfig> load_called(const std::string& name,
                                            const config::ProcedureConfig& caller) {
  const auto beside = caller.file.parent_path() / (name + ".json");
  std::error_code ignored;
  if (!caller.file.empty() && std::filesystem::is_regular_file(beside, ignored)) {
    return config::load_procedure(beside);
  }
  const auto found = config::find_config("procedures", name);
  if (!found) return found.error();
  return config::load_procedure(*found);
}

}  // namespace

Result<Plan> make_plan(const config::ProcedureConfig& procedure, const config::BenchConfig& bench,
                       const std::map<std::string, config::ParameterValue>& overrides) {
  auto steps = expand(procedure, overrides, load_called);
  if (!steps) return steps.error();
  return make_plan(procedure.name, std::move(*steps), bench);
}

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
