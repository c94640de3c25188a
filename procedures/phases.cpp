#include "procedures/phases.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <span>

#include "procedures/planned_points.hpp"
#include "procedures/sentence.hpp"

namespace fogbench::procedures {
namespace {

using StepsOfPhase = std::span<const PlannedStep>;

/// The segments that it records, a sweep's without its branches.
std::vector<std::string> recorded_by(StepsOfPhase steps) {
  std::vector<std::string> names;
  for (const PlannedStep& step : steps) {
    std::string name = std::visit(
        [](const auto& action) -> std::string {
          if constexpr (requires { action.segment; }) return action.segment;
          return {};
        },
        step.action);
    if (std::holds_alternative<SweepLevel>(step.action)) name = name.substr(0, name.find('/'));
    const bool known = std::find(names.begin(), names.end(), name) != names.end();
    if (!name.empty() && !known) names.push_back(std::move(name));
  }
  return names;
}

std::string sweep_text(StepsOfPhase steps, const SweepLevel& first) {
  double least = first.level.value, most = first.level.value;
  for (const PlannedStep& step : steps) {
    const double level = std::get<SweepLevel>(step.action).level.value;
    least = std::min(least, level);
    most = std::max(most, level);
  }
  return fmt::format("sweep {}{}: {} levels, {} to {} uT, {} each{}{}", along_text(first.axis),
                     across_text(first), steps.size(), least, most, duration_text(first.duration),
                     first.segment.empty() ? "" : " as ",
                     first.segment.substr(0, first.segment.find('/')));
}

std::string phase_text(StepsOfPhase steps) {
  const auto* const level = std::get_if<SweepLevel>(&steps.front().action);
  const std::string& what = steps.front().phase_says;
  if (what.empty() && level != nullptr) return sweep_text(steps, *level);
  std::vector<std::string> parts;
  if (what.empty()) {
    for (const PlannedStep& step : steps) parts.push_back(step.says);
    return fmt::format("{}", fmt::join(parts, "; then "));
  }
  parts = recorded_by(steps);
  if (parts.empty()) return fmt::format("{}: {}", what, steps.front().says);
  return fmt::format("{}: {}", what, fmt::join(parts, ", "));
}

}  // namespace

std::vector<Phase> phases_of(const Plan& plan) {
  std::vector<Phase> phases;
  Seconds elapsed{0.0};
  for (auto begin = plan.steps.begin(); begin != plan.steps.end();) {
    const auto end = std::find_if(begin, plan.steps.end(), [&](const PlannedStep& step) {
      return step.phase != begin->phase;
    });
    const StepsOfPhase steps(begin, end);
    Phase phase{.says = phase_text(steps), .starts_after = elapsed, .steps = steps.size()};
    for (const PlannedStep& step : steps) {
      phase.estimate += step.estimate;
      phase.points += planned_points(step);
      phase.open = phase.open || is_open(step);
    }
    elapsed += phase.estimate;
    phases.push_back(std::move(phase));
    begin = end;
  }
  return phases;
}

std::string summary_text(const Plan& plan) {
  const auto counted = [](std::size_t number, const char* what) {
    return fmt::format("{} {}{}", number, what, number == 1 ? "" : "s");
  };
  std::string points = "no points";
  if (measures(plan)) {
    points = counted(planned_points(plan), "point");
    if (std::any_of(plan.steps.begin(), plan.steps.end(), is_open)) {
      points += " and those on the way to a temperature (+)";
    }
  }
  return fmt::format("{}, about {}, {}", counted(plan.steps.size(), "step"),
                     duration_text(plan.estimate), points);
}

}  // namespace fogbench::procedures
