// The sensitivity to the field changes with the temperature.
//
// In no challenge: their procedures sweep at one temperature.

#include "model/effects/function_effect.hpp"

namespace fogbench::model::effects {

Family magnetic_temperature() {
  return along_each_axis("magnetic_temperature", [](const Axis& axis) -> FunctionParts {
    return {
        .info = {.group = EffectInfo::Group::kField,
                 .formula = axis.h + " t",
                 .columns = {""},
                 .units = {"deg/h/degC per 100 uT"},
                 .signals = {axis.signal, "temperature_c"},
                 .excited_by = "a sweep of " + axis.letter + " repeated at a second temperature",
                 .confused_with = axis.of("magnetic_linear"),
                 .source = "the Verdet constant's dependence on temperature"},
        .regressor = [axis](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
          return axis.field(signals) * excess_temperature(signals);
        },
    };
  });
}

}  // namespace fogbench::model::effects
