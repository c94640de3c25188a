// The difference of the two working sensors across the coil.

#include "model/effects/list.hpp"

namespace fogbench::model::effects {

const FunctionEffect& temperature_gradient() {
  static const FunctionEffect effect(
      {.id = "temperature_gradient",
       .formula = "T1 - T2",
       .columns = {""},
       .units = {"deg/h/degC"},
       .signals = {"temperature_gradient_c"},
       .parameters = {},
       .excited_by = "boost against normal heating; typically 0.05..1 deg/h per degC",
       .confused_with = "temperature_rate; heater_power",
       .source = "D. M. Shupe, Applied Optics 19 (1980) 654"},
      [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
        return signals.signal("temperature_gradient_c");
      });
  return effect;
}

}  // namespace fogbench::model::effects
