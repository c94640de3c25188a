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

Status repeatedly(const std::function<Status()>& action) {
  Status last;
  for (int i = 0; i < kTries; ++i) {
    last = action();
    if (last) return last;
  }
  return last;
}

Status heaters_off(drivers::Thermostat& thermostat) {
  const auto switched = thermostat.set_mode(HeatingMode::kOff);
  if (!switched) return switched;
  double power_w = 0.0;
  for (int i = 0; i < kPowerReads; ++i) {
    const auto reading = thermostat.read();
    if (!reading) return reading.error();
    if (reading->mode != HeatingMode::kOff) {
      return Error{ErrorCode::kDevice, "the heating mode reads back other than off"};
    }
    power_w = reading->boost_power.value + reading->normal_power.value;
    if (power_w <= kOffW) return {};
  }
  return Error{ErrorCode::kDevice, fmt::format("the heaters still draw {:.1f} W", power_w)};
}

}  // namespace

Status make_safe(drivers::Bench& bench) {
  std::vector<std::string> failed;
  const auto attempt = [&](const char* name, const std::function<Status()>& action) {
    const auto status = repeatedly(action);
    if (!status) failed.push_back(fmt::format("{} ({})", name, status.error().message));
  };
  if (bench.thermostat) attempt("thermostat", [&] { return heaters_off(*bench.thermostat); });
  if (bench.coil_horizontal) {
    attempt("coil_horizontal", [&] { return bench.coil_horizontal->make_safe(); });
  }
  if (bench.coil_vertical) {
    attempt("coil_vertical", [&] { return bench.coil_vertical->make_safe(); });
  }
  if (failed.empty()) return {};
  return Error{ErrorCode::kDevice,
               fmt::format("the safe state is not confirmed for {}", fmt::join(failed, "; "))};
}

}  // namespace fogbench::procedures
