// The Faraday effect: an error in proportion to the field along one axis, h in units of 100 uT.

#include "model/effects/function_effect.hpp"

namespace fogbench::model::effects {

Family magnetic_linear() {
  return along_each_axis("magnetic_linear", [](const Axis& axis) -> FunctionParts {
    return {
        .info = {.group = EffectInfo::Group::kField,
                 .formula = axis.h,
                 .columns = {""},
                 .units = {"deg/h per 100 uT"},
                 .signals = {axis.signal},
                 .excited_by =
                     "coils along " + axis.letter + "; typically 0.005..3 deg/h per 100 uT",
                 .confused_with = axis.of("magnetic_temperature") + ", at one temperature",
                 .source = "K. Hotate, K. Tabe, Applied Optics 25 (1986) 1086: Faraday effect in a "
                           "fibre coil",
                 .field_sensitivity = true,
                 .elementary_in = axis.signal},
        .regressor = [axis](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
          return axis.field(signals);
        },
    };
  });
}

}  // namespace fogbench::model::effects
