// An error that is even in the field.

#include "model/effects/function_effect.hpp"

namespace fogbench::model::effects {

Family magnetic_quadratic() {
  return along_each_axis("magnetic_quadratic", [](const Axis& axis) -> FunctionParts {
    return {
        .info = {.group = EffectInfo::Group::kField,
                 .formula = axis.h + "^2",
                 .columns = {""},
                 .units = {"deg/h per (100 uT)^2"},
                 .signals = {axis.signal},
                 .excited_by = "both signs of the field",
                 .confused_with = "coil_heating",
                 .source = "second term of the expansion in the field",
                 .elementary_in = axis.signal,
                 .hidden_because = axis.needs_three_levels(),
                 .in_challenge = InChallenge{InChallenge::By::kSweep, 1}},
        .regressor = [axis](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
          return axis.field(signals).square();
        },
    };
  });
}

}  // namespace fogbench::model::effects
