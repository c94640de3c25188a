#include "procedures/planned_points.hpp"

#include <algorithm>
#include <cmath>
#include <variant>

namespace fogbench::procedures {

std::size_t windows_in(Seconds wait, Seconds window) {
  // Three times 0.1 s are within 0.3 s, though not in floating point.
  constexpr double kRounding = 1e-6;
  const double fit = std::floor(wait / window + kRounding);
  return fit > 0.0 ? static_cast<std::size_t>(fit) : 0;
}

std::size_t planned_points(const PlannedStep& step) {
  if (std::holds_alternative<Average>(step.action)) return 1;
  if (std::holds_alternative<SweepLevel>(step.action)) return 1;
  return std::visit(
      [&step](const auto& action) -> std::size_t {
        if constexpr (requires { action.window; }) {
          return action.segment.empty() || is_open(step) ? 0
                                                         : windows_in(step.estimate, action.window);
        }
        return 0;
      },
      step.action);
}

bool is_open(const PlannedStep& step) {
  const auto* settle = std::get_if<SettleTemperature>(&step.action);
  return settle != nullptr && !settle->segment.empty();
}

std::size_t planned_points(const Plan& plan) {
  std::size_t points = 0;
  for (const PlannedStep& step : plan.steps) points += planned_points(step);
  return points;
}

bool measures(const Plan& plan) {
  return std::any_of(plan.steps.begin(), plan.steps.end(), [](const PlannedStep& step) {
    return std::visit(
        [](const auto& action) {
          if constexpr (requires { action.window; }) return !action.segment.empty();
          return requires {
            action.segment;
          };
        },
        step.action);
  });
}

}  // namespace fogbench::procedures
