#include "simulator/thermal_physics.hpp"

#include <cmath>
#include <numbers>

#include "config/units.hpp"

namespace fogbench::simulator {

ThermalPhysics::ThermalPhysics(const config::ThermalPlant& plant, double step_s)
    : plant_(plant),
      step_s_(step_s),
      delay_(static_cast<std::size_t>(std::lround(plant.dead_time.count() / step_s))),
      ambient_c_(ambient_at(0.0)),
      node_c_{ambient_c_, ambient_c_, ambient_c_} {}

double ThermalPhysics::ambient_at(double time_s) const {
  const double phase = 2.0 * std::numbers::pi * time_s / plant_.ambient_period.count();
  return plant_.ambient.value + plant_.ambient_wander.value * std::sin(phase);
}

ThermalPhysics::Nodes ThermalPhysics::slope_c_per_s(const Nodes& node_c, double ambient_c,
                                                    double heat_w) const {
  const auto [heater, carrier, coil] = node_c;
  const double to_carrier = plant_.heater_carrier_w_per_k * (heater - carrier);
  const double to_coil = plant_.carrier_coil_w_per_k * (carrier - coil);
  const double to_ambient = plant_.carrier_ambient_w_per_k * (carrier - ambient_c);
  return {(heat_w - to_carrier) / plant_.heater_j_per_k,
          (to_carrier - to_coil - to_ambient) / plant_.carrier_j_per_k,
          to_coil / plant_.coil_j_per_k};
}

void ThermalPhysics::advance(const HeaterPower& power) {
  HeaterPower arriving = power;
  if (!delay_.empty()) std::swap(arriving, delay_[steps_ % delay_.size()]);
  ++steps_;
  const double next_ambient_c = ambient_at(static_cast<double>(steps_) * step_s_);

  const Nodes first = slope_c_per_s(node_c_, ambient_c_, arriving.heat_w());
  Nodes predicted;
  for (std::size_t i = 0; i < 3; ++i) predicted[i] = node_c_[i] + step_s_ * first[i];
  const Nodes second = slope_c_per_s(predicted, next_ambient_c, arriving.heat_w());
  for (std::size_t i = 0; i < 3; ++i) node_c_[i] += step_s_ * (first[i] + second[i]) / 2.0;
  ambient_c_ = next_ambient_c;

  const double rate =
      slope_c_per_s(node_c_, ambient_c_, arriving.heat_w())[1] * config::kSecondsPerHour;
  carrier_acceleration_c_per_h2_ =
      (rate - carrier_rate_c_per_h_) / (step_s_ / config::kSecondsPerHour);
  carrier_rate_c_per_h_ = rate;
  const double settled_c = plant_.gradient_c_per_w * arriving.boost_w;
  const double lag_s = plant_.gradient_lag.count();
  gradient_c_ =
      lag_s > 0.0 ? settled_c + (gradient_c_ - settled_c) * std::exp(-step_s_ / lag_s) : settled_c;
}

}  // namespace fogbench::simulator
