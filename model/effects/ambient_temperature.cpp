// The room, beyond the thermostat.

#include "model/effects/list.hpp"

namespace fogbench::model::effects {

const FunctionEffect& ambient_temperature() {
  static const FunctionEffect effect(
      {.id = "ambient_temperature",
       .formula = "ambient - T_ref",
       .columns = {""},
       .units = {"deg/h/degC"},
       .signals = {"ambient_c"},
       .parameters = {},
       .excited_by = "slow changes of the room",
       .confused_with = "drift_linear",
       .source = "bench experience"},
      [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
        return signals.signal("ambient_c").array() - signals.reference_temperature_c();
      });
  return effect;
}

}  // namespace fogbench::model::effects
