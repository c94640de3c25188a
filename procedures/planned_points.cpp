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
  const auto* wait = std::get_if<Wait>(&step.action);
  if (wait == nullptr || wait->segment.empty()) return 0;
  return windows_in(step.estimate, wait->window);
}

std::size_t planned_points(const Plan& plan) {
  std::size_t points = 0;
  for (const PlannedStep& step : plan.steps) points += planned_points(step);
  return points;
}

bool measures(const Plan& plan) {
  return std::any_of(plan.steps.begin(), plan.steps.end(), [](const PlannedStep& step) {
    const auto* settle = std::get_if<SettleTemperature>(&step.action);
    const auto* wait = std::get_if<Wait>(&step.action);
    return std::holds_alternative<Average>(step.action) ||
           std::holds_alternative<SweepLevel>(step.action) ||
           (settle != nullptr && !settle->segment.empty()) ||
           (wait != nullptr && !wait->segment.empty());
  });
}

}  // namespace fogbench::procedures
