#include "procedures/resume_plan.hpp"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

namespace fogbench::procedures {
namespace {

using Steps = std::vector<PlannedStep>;

template <class Action>
bool is(const PlannedStep& step) {
  return std::holds_alternative<Action>(step.action);
}

/// A block keeps together: what it waits for inside is its own.
bool heats_or_waits(const PlannedStep& step) {
  if (step.block != 0) return false;
  return is<SetTemperature>(step) || is<Ramp>(step) || is<SettleTemperature>(step) ||
         is<Wait>(step);
}

/// The first of the steps in a row that heat, settle or wait, up to the one before `end`. A ramp
/// begins a row of its own: what came before is done, and can be gone back to.
std::size_t start_of_heating(const Steps& steps, std::size_t end) {
  while (end > 0 && heats_or_waits(steps[end - 1])) {
    if (is<Ramp>(steps[--end])) break;
  }
  return end;
}

template <class... Actions>
std::optional<std::size_t> last(const Steps& steps, std::size_t before) {
  for (std::size_t i = before; i-- > 0;) {
    if ((is<Actions>(steps[i]) || ...)) return i;
  }
  return std::nullopt;
}

double operating_time_s(const PlannedStep& step) {
  const auto* const wait = std::get_if<Wait>(&step.action);
  return wait != nullptr ? wait->operating_time.count() : 0.0;
}

/// Indices below `first` of what is done again, in order.
std::vector<std::size_t> redone_steps(const Steps& steps, std::size_t first) {
  std::vector<bool> again(first, false);
  const auto mark = [&again](std::size_t begin, std::size_t end) {
    std::fill(again.begin() + static_cast<std::ptrdiff_t>(begin),
              again.begin() + static_cast<std::ptrdiff_t>(end), true);
  };
  if (const auto heat = last<SetTemperature, Ramp>(steps, first)) {
    std::size_t end = *heat + 1;
    while (end < first && heats_or_waits(steps[end])) ++end;
    mark(std::min(*heat, start_of_heating(steps, end)), end);
  }
  mark(start_of_heating(steps, first), first);
  const auto turn = last<Rotate>(steps, first);
  if (turn) again[*turn] = true;
  const auto nulled = last<CompensateField>(steps, first);
  if (nulled && (!turn || *turn < *nulled)) again[*nulled] = true;

  // Only the longest warm-up, and only where it is not among the others.
  std::optional<std::size_t> longest;
  for (std::size_t i = 0; i < first; ++i) {
    const double least = longest ? operating_time_s(steps[*longest]) : 0.0;
    const double here = operating_time_s(steps[i]);
    if (here > least || (again[i] && here > 0.0 && here == least)) longest = i;
  }
  if (longest) again[*longest] = true;

  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < first; ++i) {
    if (again[i]) indices.push_back(i);
  }
  return indices;
}

/// Appends a step, so that it records nothing: its points have been recorded. The way of a ramp is
/// gone as fast as the heaters can: how it came there the first time is on record.
void append_redone(PlannedStep step, Steps& steps) {
  step.path = kRedone + step.path;
  step.block = 0;
  std::visit(
      [](auto& action) {
        if constexpr (requires { action.window; }) action.segment.clear();
      },
      step.action);
  if (const auto* ramp = std::get_if<Ramp>(&step.action)) {
    const Celsius to = ramp->to;
    PlannedStep heat = step;
    heat.action = SetTemperature{to, HeatingMode::kBoost};
    heat.path += ".1";
    steps.push_back(std::move(heat));
    step.action = SettleTemperature{.band = Celsius{0.5},
                                    .dwell = Seconds{0.0},
                                    .slope_c_per_h = 1.0,
                                    .timeout = Seconds{28800.0},
                                    .segment = {},
                                    .window = Seconds{60.0}};
    step.path += ".2";
  }
  steps.push_back(std::move(step));
}

}  // namespace

std::size_t first_step_left(const Plan& whole, std::size_t at) {
  const Steps& steps = whole.steps;
  if (at >= steps.size()) return steps.size();
  if (const int block = steps[at].block; block != 0) {
    while (at > 0 && steps[at - 1].block == block) --at;
    return at;
  }
  return heats_or_waits(steps[at]) && !is<Ramp>(steps[at]) ? start_of_heating(steps, at) : at;
}

Result<ResumePlan> resume_plan(const Plan& whole, std::size_t at,
                               const config::BenchConfig& bench) {
  ResumePlan resumed;
  resumed.first = first_step_left(whole, at);
  Steps steps;
  if (resumed.first < whole.steps.size()) {
    for (const std::size_t index : redone_steps(whole.steps, resumed.first)) {
      append_redone(whole.steps[index], steps);
    }
  }
  resumed.redone = steps.size();
  steps.insert(steps.end(), whole.steps.begin() + static_cast<std::ptrdiff_t>(resumed.first),
               whole.steps.end());
  auto plan = make_plan(whole.procedure, std::move(steps), bench);
  if (!plan) return plan.error();
  resumed.plan = std::move(*plan);
  resumed.plan.files = whole.files;
  resumed.plan.needs = whole.needs;
  return resumed;
}

}  // namespace fogbench::procedures
