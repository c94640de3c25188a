#include "simulator/thermostat_controller.hpp"

#include <algorithm>
#include <cmath>

namespace fogbench::simulator {

using config::HeatingMode;

namespace {

/// The derivative is low-passed over this part of the derivative time: the usual compromise
/// between lead and noise.
constexpr double kDerivativeFilter = 1.0 / 8.0;

}  // namespace

ThermostatController::ThermostatController(const config::ThermalPlant& plant, double step_s,
                                           std::uint64_t seed)
    : plant_(plant), step_s_(step_s), noise_(seed), target_c_(plant.ambient.value) {
  lagged_c_.fill(plant.ambient.value);
  for (std::size_t i = 0; i < 3; ++i) {
    sensors_c_[i] = measure(plant.ambient.value + plant.sensor_offset_c[i]);
  }
  ambient_c_ = measure(plant.ambient.value);
  previous_c_ = (sensors_c_[0] + sensors_c_[1]) / 2.0;
}

void ThermostatController::set_target(config::Celsius target) {
  target_c_ = target.value;
  boosting_ = mode_ == HeatingMode::kBoost;
}

void ThermostatController::set_mode(HeatingMode mode) {
  mode_ = mode;
  boosting_ = mode == HeatingMode::kBoost;
  if (mode == HeatingMode::kOff) {
    integral_w_ = 0.0;
    power_ = {};
  }
}

void ThermostatController::advance(const ThermalPhysics& thermal) {
  const double half_gradient = thermal.gradient_c() / 2.0;
  const std::array<double, 3> at_sensor{thermal.carrier_c() + half_gradient,
                                        thermal.carrier_c() - half_gradient, thermal.carrier_c()};
  const double lag_s = plant_.sensor_lag.count();
  const double follow = lag_s > 0.0 ? -std::expm1(-step_s_ / lag_s) : 1.0;
  for (std::size_t i = 0; i < 3; ++i) lagged_c_[i] += follow * (at_sensor[i] - lagged_c_[i]);

  since_cycle_s_ += step_s_;
  if (since_cycle_s_ + 1e-9 < kCycleS) return;
  sample(thermal);
  control();
  since_cycle_s_ = 0.0;
}

double ThermostatController::measure(double true_c) {
  const double noisy = true_c + plant_.sensor_noise.value * noise_();
  const double lsb = plant_.sensor_resolution.value;
  return lsb > 0.0 ? lsb * std::nearbyint(noisy / lsb) : noisy;
}

void ThermostatController::sample(const ThermalPhysics& thermal) {
  for (std::size_t i = 0; i < 3; ++i) {
    sensors_c_[i] = measure(lagged_c_[i] + plant_.sensor_offset_c[i]);
  }
  ambient_c_ = measure(thermal.ambient_c());
}

void ThermostatController::control() {
  const double measured_c = (sensors_c_[0] + sensors_c_[1]) / 2.0;
  const double filter_s = std::max(kDerivativeFilter * plant_.pid_derivative.count(), kCycleS);
  const double slope = (measured_c - previous_c_) / since_cycle_s_;
  slope_c_per_s_ += std::min(1.0, since_cycle_s_ / filter_s) * (slope - slope_c_per_s_);
  previous_c_ = measured_c;
  if (mode_ == HeatingMode::kOff) return;

  const double error_c = target_c_ - measured_c;
  if (boosting_ && error_c <= plant_.boost_drop_out.value) boosting_ = false;
  if (boosting_) {
    power_ = {.boost_w = plant_.boost_maximum.value};
    return;
  }
  const double maximum_w = plant_.normal_maximum.value;
  const double minimum_w = -plant_.cooling_maximum.value;
  const double wanted_w =
      plant_.pid_gain_w_per_k * (error_c - plant_.pid_derivative.count() * slope_c_per_s_) +
      integral_w_;
  const bool pushes_against_clamp =
      (wanted_w > maximum_w && error_c > 0.0) || (wanted_w < minimum_w && error_c < 0.0);
  if (!pushes_against_clamp) {
    integral_w_ += plant_.pid_gain_w_per_k * error_c * since_cycle_s_ / plant_.pid_integral.count();
    integral_w_ = std::clamp(integral_w_, minimum_w, maximum_w);
  }
  const double power_w = std::clamp(wanted_w, minimum_w, maximum_w);
  power_ = {
      .boost_w = 0.0, .normal_w = std::max(power_w, 0.0), .cooling_w = std::max(-power_w, 0.0)};
}

}  // namespace fogbench::simulator
