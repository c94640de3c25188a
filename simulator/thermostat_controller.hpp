#pragma once
// The thermostat's controller with its three sensors on the carrier and one in the room: everything
// that its registers show. It samples, controls and refreshes its registers once per cycle, so that
// what a master reads does not depend on how often it reads.
//
// In boost mode the 12 W heaters run at full power until the measured temperature comes within
// `boost_drop_out` of the target, then the normal-mode heater takes over for good. The normal
// heater follows a PID: derivative on the measurement, output clamped to [0, maximum], or where a
// chamber cools, [-cooling maximum, maximum], and the integral held while the output is at a clamp
// that the error pushes against (anti-windup).

#include <array>

#include "config/bench.hpp"
#include "config/procedure.hpp"
#include "simulator/random.hpp"
#include "simulator/thermal_physics.hpp"

namespace fogbench::simulator {

class ThermostatController {
 public:
  /// Typical scan time of a panel controller.
  static constexpr double kCycleS = 0.2;

  ThermostatController(const config::ThermalPlant& plant, double step_s, std::uint64_t seed);

  /// One step of the plant: the sensors follow, and at the end of a cycle the output changes.
  void advance(const ThermalPhysics& thermal);

  void set_target(config::Celsius target);
  void set_mode(config::HeatingMode mode);

  config::Celsius target() const { return config::Celsius{target_c_}; }
  config::HeatingMode mode() const { return mode_; }
  const HeaterPower& power() const { return power_; }
  /// Working 1, working 2, control, as sampled in the last cycle.
  const std::array<double, 3>& sensors_c() const { return sensors_c_; }
  double ambient_c() const { return ambient_c_; }

 private:
  void sample(const ThermalPhysics& thermal);
  void control();
  double measure(double true_c);

  const config::ThermalPlant plant_;
  const double step_s_;
  NormalSource noise_;
  config::HeatingMode mode_ = config::HeatingMode::kOff;
  double target_c_;
  double since_cycle_s_ = 0.0;
  std::array<double, 3> lagged_c_;
  std::array<double, 3> sensors_c_;
  double ambient_c_;
  bool boosting_ = false;
  double integral_w_ = 0.0;
  double previous_c_;
  double slope_c_per_s_ = 0.0;  ///< filtered, for the derivative
  HeaterPower power_;
};

}  // namespace fogbench::simulator
