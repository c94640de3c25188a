// What the heater current itself adds.

#include "model/effects/function_effect.hpp"

namespace fogbench::model::effects {

Family heater_power() {
  return {{
      .info = {.id = "heater_power",
               .group = EffectInfo::Group::kTemperature,
               .formula = "heater power",
               .columns = {""},
               .units = {"deg/h/W"},
               .signals = {"heater_w"},
               .excited_by = "switching the heater at constant temperature",
               .confused_with = "temperature_linear: the duty follows t",
               .source = "bench experience: field and gradient of the heater",
               .in_challenge = InChallenge{InChallenge::By::kHeating, 12}},
      .regressor = [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
        return signals.signal("heater_w");
      },
  }};
}

}  // namespace fogbench::model::effects
