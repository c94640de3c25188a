// The sensitivity to the field changes while the coil warms: a thermal gradient turns the
// polarisation that the field acts on.
//
// In no challenge: their procedures sweep at a temperature that stands still.

#include "model/effects/function_effect.hpp"
#include "model/effects/rate_of_windows.hpp"

namespace fogbench::model::effects {

Family magnetic_temperature_rate() {
  return along_each_axis("magnetic_temperature_rate", [](const Axis& axis) -> FunctionParts {
    return {
        .info = {.group = EffectInfo::Group::kField,
                 .formula = axis.h + " dT/dt",
                 .columns = {""},
                 .units = {"(deg/h)/(degC/h) per 100 uT"},
                 .signals = {axis.signal, "temperature_rate_c_per_h"},
                 .excited_by = "a sweep of " + axis.letter + " repeated on a ramp of temperature",
                 .confused_with = axis.of("magnetic_temperature") + "; an ageing sensitivity",
                 .source = "product of the Shupe and the Faraday effect, to first order"},
        .regressor = [axis](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
          return axis.field(signals) * signals.signal("temperature_rate_c_per_h").array();
        },
        .other_shapes = with_rate_of_windows,
    };
  });
}

}  // namespace fogbench::model::effects
