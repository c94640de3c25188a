// What the heater current itself adds.

#include "model/effects/list.hpp"

namespace fogbench::model::effects {

const FunctionEffect& heater_power() {
  static const FunctionEffect effect(
      {.id = "heater_power",
       .formula = "heater power",
       .columns = {""},
       .units = {"deg/h/W"},
       .signals = {"heater_w"},
       .parameters = {},
       .excited_by = "switching the heater at constant temperature",
       .confused_with = "temperature_linear: the duty follows t",
       .source = "bench experience: field and gradient of the heater"},
      [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
        return signals.signal("heater_w");
      });
  return effect;
}

}  // namespace fogbench::model::effects
