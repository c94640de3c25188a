#include "drivers/safe_state.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace fogbench::drivers {
namespace {

/// One lost message must not leave a heater on.
constexpr int kRounds = 3;

struct Task {
  const char* name;
  Actuator* actuator;
};

void tell(const Task& task, Safety& safety) {
  const Status told = task.actuator->switch_off();
  if (told) {
    safety.state = Safety::State::kCommanded;
    return;
  }
  safety.failure = told.error().message;
  const ErrorCode code = told.error().code;
  const bool is_reached = code != ErrorCode::kUnplugged && code != ErrorCode::kHeld;
  if (is_reached) safety.state = Safety::State::kCommanded;
}

void confirm(const Task& task, Safety& safety) {
  const Status off = task.actuator->confirm_off();
  if (off) {
    safety.state = Safety::State::kReadBack;
    safety.failure.clear();
  } else {
    safety.failure = off.error().message;
  }
}

SafetyReport make_safe(std::vector<Task> tasks) {
  std::erase_if(tasks, [](const Task& task) { return task.actuator == nullptr; });
  SafetyReport report;
  for (const Task& task : tasks) {
    report.actuators.push_back({task.name, Safety::State::kUnreachable, {}});
    tell(task, report.actuators.back());
  }
  for (int round = 0; round < kRounds && !report.reached(); ++round) {
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      Safety& safety = report.actuators[i];
      if (safety.state == Safety::State::kReadBack) continue;
      if (round > 0) tell(tasks[i], safety);
      confirm(tasks[i], safety);
    }
  }
  return report;
}

std::string text_of(const Safety& safety) {
  switch (safety.state) {
    case Safety::State::kReadBack:
      return safety.actuator + " off, read back";
    case Safety::State::kCommanded:
      return fmt::format("{} commanded off, not confirmed ({})", safety.actuator, safety.failure);
    case Safety::State::kUnreachable:
      break;
  }
  return fmt::format("{} unreachable ({})", safety.actuator, safety.failure);
}

}  // namespace

bool SafetyReport::reached() const {
  return std::all_of(actuators.begin(), actuators.end(),
                     [](const Safety& safety) { return safety.state == Safety::State::kReadBack; });
}

std::string SafetyReport::text() const {
  std::vector<std::string> texts;
  for (const Safety& safety : actuators) texts.push_back(text_of(safety));
  return fmt::format("{}", fmt::join(texts, "; "));
}

Status SafetyReport::status() const {
  std::vector<std::string> failed;
  for (const Safety& safety : actuators) {
    if (safety.state != Safety::State::kReadBack) failed.push_back(text_of(safety));
  }
  if (failed.empty()) return {};
  return Error{ErrorCode::kDevice,
               fmt::format("the safe state is not confirmed for {}", fmt::join(failed, "; "))};
}

SafetyReport make_safe(const Bench& bench) {
  // The coils first: a message switches them off.
  return make_safe({{"coil_horizontal", bench.coil_horizontal.get()},
                    {"coil_vertical", bench.coil_vertical.get()},
                    {"thermostat", bench.thermostat.get()}});
}

SafetyReport coils_off(const Bench& bench) {
  return make_safe({{"coil_horizontal", bench.coil_horizontal.get()},
                    {"coil_vertical", bench.coil_vertical.get()}});
}

}  // namespace fogbench::drivers
