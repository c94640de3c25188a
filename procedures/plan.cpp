#include "procedures/plan.hpp"

#include <algorithm>
#include <utility>

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
                       const Parameters& overrides) {
  std::vector<std::filesystem::path> files;
  const auto remember = [&files](const std::filesystem::path& file) {
    if (std::find(files.begin(), files.end(), file) == files.end()) files.push_back(file);
  };
  remember(procedure.file);
  auto steps = expand(procedure, overrides, [&](const auto& name, const auto& caller) {
    auto called = load_called(name, caller);
    if (called) remember(called->file);
    return called;
  });
  if (!steps) return steps.error();
  auto plan = make_plan(procedure.name, std::move(*steps), bench);
  if (plan) plan->files = std::move(files);
  return plan;
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
