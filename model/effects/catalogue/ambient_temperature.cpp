// The room, beyond the thermostat.
//
// In no challenge: the room hardly moves.

#include "model/effects/function_effect.hpp"

namespace fogbench::model::effects {

Family ambient_temperature() {
  return {{
      .info = {.id = "ambient_temperature",
               .group = EffectInfo::Group::kTemperature,
               .formula = "ambient - T_ref",
               .columns = {""},
               .units = {"deg/h/degC"},
               .signals = {"ambient_c"},
               .excited_by = "slow changes of the room",
               .confused_with = "drift_linear",
               .source = "bench experience",
               .slow = true},
      .regressor = [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
        return signals.signal("ambient_c").array() - signals.reference_temperature_c();
      },
  }};
}

}  // namespace fogbench::model::effects
