// The part of the error that follows the change of the temperature rate.
//
// In no challenge: windows of a minute round the edges of the steps.

#include "model/effects/function_effect.hpp"

namespace fogbench::model::effects {

Family temperature_acceleration() {
  return {{
      .info = {.id = "temperature_acceleration",
               .group = EffectInfo::Group::kTemperature,
               .formula = "d2T/dt2",
               .columns = {""},
               .units = {"(deg/h)/(degC/h^2)"},
               .signals = {"temperature_acceleration_c_per_h2"},
               .excited_by = "the edges of temperature steps",
               .confused_with = "temperature_rate_lagged",
               .source = "first term of the expansion of a lag"},
      .regressor = [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
        return signals.signal("temperature_acceleration_c_per_h2");
      },
  }};
}

}  // namespace fogbench::model::effects
