#include <fmt/format.h>
#include <fmt/ranges.h>

#include <functional>
#include <string>
#include <vector>

#include "procedures/run_engine.hpp"

namespace fogbench::procedures {
namespace {

/// One lost message must not leave a heater on.
constexpr int kTries = 3;
/// A controller refreshes its registers once per cycle, a few reads later at most.
constexpr int kPowerReads = 10;
/// Below what any heater is switched at, above the resolution of a power reading.
constexpr double kOffW = 0.1;

Status heaters_off(drivers::Thermostat& thermostat) {
  const auto switched = thermostat.set_mode(HeatingMode::kOff);
  if (!switched) return switched;
  Status last;
  for (int i = 0, failed = 0; i < kPowerReads && failed < kTries; ++i) {
    const auto reading = thermostat.read();
    if (!reading) {
      last = reading.error();
      ++failed;
      continue;
    }
    if (reading->mode != HeatingMode::kOff) {
      return Error{ErrorCode::kDevice, "the heating mode reads back other than off"};
    }
    const double power_w = reading->boost_power.value + reading->normal_power.value;
    if (power_w <= kOffW) return {};
    last = Error{ErrorCode::kDevice, fmt::format("the heaters still draw {:.1f} W", power_w)};
  }
  return last;
}

}  // namespace

Status make_safe(drivers::Bench& bench) {
  struct Task {
    const char* name;
    std::function<Status()> act;
    bool done = false;
    std::string failure;
  };
  std::vector<Task> tasks;
  const auto add = [&tasks](const char* name, std::function<Status()> act) {
    tasks.push_back({name, std::move(act), false, {}});
  };
  // The coils first: a message switches them off. In rounds, so that a dead instrument delays the
  // others by one try instead of all of its own.
  if (bench.coil_horizontal)
    add("coil_horizontal", [&] { return bench.coil_horizontal->make_safe(); });
  if (bench.coil_vertical) add("coil_vertical", [&] { return bench.coil_vertical->make_safe(); });
  if (bench.thermostat) add("thermostat", [&] { return heaters_off(*bench.thermostat); });
  for (int round = 0; round < kTries; ++round) {
    for (Task& task : tasks) {
      if (task.done) continue;
      const Status outcome = task.act();
      task.done = static_cast<bool>(outcome);
      if (!outcome) task.failure = fmt::format("{} ({})", task.name, outcome.error().message);
    }
  }
  std::vector<std::string> failed;
  for (const Task& task : tasks) {
    if (!task.done) failed.push_back(task.failure);
  }
  if (failed.empty()) return {};
  return Error{ErrorCode::kDevice,
               fmt::format("the safe state is not confirmed for {}", fmt::join(failed, "; "))};
}

}  // namespace fogbench::procedures
