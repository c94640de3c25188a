// The difference of the two working sensors across the coil.

#include "model/effects/function_effect.hpp"

namespace fogbench::model::effects {

Family temperature_gradient() {
  return {{
      .info = {.id = "temperature_gradient",
               .group = EffectInfo::Group::kTemperature,
               .formula = "T1 - T2",
               .columns = {""},
               .units = {"deg/h/degC"},
               .signals = {"temperature_gradient_c"},
               .excited_by = "boost against normal heating; typically 0.05..1 deg/h per degC",
               .confused_with = "temperature_rate; heater_power",
               .source = "D. M. Shupe, Applied Optics 19 (1980) 654",
               .elementary_in = "temperature_gradient_c",
               .in_challenge = InChallenge{InChallenge::By::kHeating, 9}},
      .regressor = [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
        return signals.signal("temperature_gradient_c");
      },
  }};
}

}  // namespace fogbench::model::effects
