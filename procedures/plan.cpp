#include "procedures/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "config/paths.hpp"
#include "procedures/check_limits.hpp"
#include "procedures/estimate.hpp"
#include "procedures/expand.hpp"
#include "procedures/sentence.hpp"

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

Plan plan_of(const std::string& name, std::vector<PlannedStep> steps,
             const config::BenchConfig& bench, std::vector<Error>& problems) {
  estimate_durations(steps, bench);
  Plan plan{.procedure = name, .steps = std::move(steps)};
  plan.limits_met = check_limits(name, plan.steps, bench, problems);
  for (PlannedStep& step : plan.steps) {
    step.says = sentence(step);
    plan.estimate += step.estimate;
  }
  return plan;
}

/// Notes everything that is wrong; the plan is one when nothing is.
Plan plan_of(const config::ProcedureConfig& procedure, const config::BenchConfig& bench,
             const Parameters& overrides, std::vector<Error>& problems) {
  std::vector<std::filesystem::path> files;
  std::vector<std::string> needs;
  const auto note_needs = [&](const config::ProcedureConfig& its) -> Status {
    const auto measured = config::auxiliary_channels(bench);
    for (const std::string& name : its.needs) {
      if (std::none_of(measured.begin(), measured.end(),
                       [&](const auto& channel) { return channel.name == name; })) {
        return Error{ErrorCode::kBadInput,
                     fmt::format("{}: /needs: no auxiliary sensor of the bench {} measures \"{}\"",
                                 its.file.filename().string(), bench.name, name)};
      }
      if (std::find(needs.begin(), needs.end(), name) == needs.end()) needs.push_back(name);
    }
    return {};
  };
  if (const Status noted = note_needs(procedure); !noted) problems.push_back(noted.error());
  const auto remember = [&files](const std::filesystem::path& file) {
    if (std::find(files.begin(), files.end(), file) == files.end()) files.push_back(file);
  };
  remember(procedure.file);
  const auto load = [&](const auto& name, const auto& caller) -> Result<config::ProcedureConfig> {
    auto called = load_called(name, caller);
    if (!called) return called;
    remember(called->file);
    if (const Status noted = note_needs(*called); !noted) return noted.error();
    return called;
  };
  Plan plan =
      plan_of(procedure.name, expand(procedure, overrides, load, problems), bench, problems);
  plan.files = std::move(files);
  plan.needs = std::move(needs);
  return plan;
}

/// The plan, or the first of the problems.
Result<Plan> first_of(Plan plan, std::vector<Error> problems) {
  if (!problems.empty()) return std::move(problems.front());
  return plan;
}

}  // namespace

Result<Plan> make_plan(const config::ProcedureConfig& procedure, const config::BenchConfig& bench,
                       const Parameters& overrides) {
  std::vector<Error> problems;
  Plan plan = plan_of(procedure, bench, overrides, problems);
  return first_of(std::move(plan), std::move(problems));
}

std::vector<Error> check_procedure(const config::ProcedureConfig& procedure,
                                   const config::BenchConfig& bench, const Parameters& overrides) {
  std::vector<Error> problems;
  plan_of(procedure, bench, overrides, problems);
  return problems;
}

Result<Plan> make_plan(const std::string& name, std::vector<PlannedStep> steps,
                       const config::BenchConfig& bench) {
  std::vector<Error> problems;
  Plan plan = plan_of(name, std::move(steps), bench, problems);
  return first_of(std::move(plan), std::move(problems));
}

}  // namespace fogbench::procedures
