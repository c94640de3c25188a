// Layers of the winding that warm one after the other: the part of the error that follows how fast
// the difference across the coil changes.
//
// In no challenge: the simulated gradient follows the heaters at once (gradient_lag_s).

#include "model/effects/function_effect.hpp"

namespace fogbench::model::effects {

Family temperature_gradient_rate() {
  return {{
      .info = {.id = "temperature_gradient_rate",
               .group = EffectInfo::Group::kTemperature,
               .formula = "d(T1 - T2)/dt",
               .columns = {""},
               .units = {"(deg/h)/(degC/h)"},
               .signals = {"temperature_gradient_rate_c_per_h"},
               .excited_by = "switching between boost and normal heating",
               .confused_with = "temperature_acceleration",
               .source = "F. Mohr, Journal of Lightwave Technology 14 (1996) 27"},
      .regressor = [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
        return signals.signal("temperature_gradient_rate_c_per_h");
      },
  }};
}

}  // namespace fogbench::model::effects
