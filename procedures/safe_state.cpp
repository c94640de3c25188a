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
  const auto switched = repeatedly([&] { return thermostat.set_mode(HeatingMode::kOff); });
  if (!switched) return switched;
  Status last;
  for (int i = 0; i < kPowerReads; ++i) {
    const auto reading = thermostat.read();
    if (!reading) {
      last = reading.error();
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
  std::vector<std::string> failed;
  const auto expect = [&](const char* name, const Status& status) {
    if (!status) failed.push_back(fmt::format("{} ({})", name, status.error().message));
  };
  const auto current_off = [](drivers::CoilSupply& coil) {
    return repeatedly([&] { return coil.make_safe(); });
  };
  if (bench.thermostat) expect("thermostat", heaters_off(*bench.thermostat));
  if (bench.coil_horizontal) expect("coil_horizontal", current_off(*bench.coil_horizontal));
  if (bench.coil_vertical) expect("coil_vertical", current_off(*bench.coil_vertical));
  if (failed.empty()) return {};
  return Error{ErrorCode::kDevice,
               fmt::format("the safe state is not confirmed for {}", fmt::join(failed, "; "))};
}

}  // namespace fogbench::procedures
