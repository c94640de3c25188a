#pragma once
// What the bench's heaters, its cooler and the room can do to the gyro's temperature, from the
// figures of the bench file (config::ThermalReach): where it can be held, and how fast it can
// change.

#include <optional>

#include "config/bench.hpp"
#include "config/procedure.hpp"
#include "config/units.hpp"

namespace fogbench::procedures {

class Reach {
 public:
  Reach(const config::ThermalReach& figures, config::Celsius room)
      : figures_(figures), room_(room) {}

  /// What the normal heater holds, and what the cooler does: without one, the room's temperature.
  config::Celsius highest() const;
  config::Celsius lowest() const;
  bool cools() const { return figures_.cooling.value > 0.0; }

  /// Of a ramp at that temperature, with the heaters of `mode`; at most 0 where it stands still.
  config::CelsiusPerHour fastest_up(config::Celsius at, config::HeatingMode mode) const;
  config::CelsiusPerHour fastest_down(config::Celsius at) const;
  /// Where a ramp of that rate must end: beyond, it cannot be followed.
  config::Celsius end_up(config::CelsiusPerHour rate, config::HeatingMode mode) const;
  config::Celsius end_down(config::CelsiusPerHour rate) const;

 private:
  double heating_c_per_h(config::HeatingMode mode) const;
  /// What a rate of heating adds up to against the losses, degC.
  double rise_c(double c_per_h) const { return c_per_h * figures_.time_constant.count() / 3600.0; }

  config::ThermalReach figures_;
  config::Celsius room_;
};

/// Nothing where the bench's file does not say it.
std::optional<Reach> reach_of(const config::BenchConfig& bench);

}  // namespace fogbench::procedures
