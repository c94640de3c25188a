// An error that is odd in the field and flattens: the shield, or the core of a sensor, saturates.

#include "model/effects/function_effect.hpp"

namespace fogbench::model::effects {

Family magnetic_saturation() {
  return along_each_axis("magnetic_saturation", [](const Axis& axis) -> FunctionParts {
    return {
        .info = {.group = EffectInfo::Group::kField,
                 .formula = "tanh(" + axis.h + " / hs)",
                 .columns = {""},
                 .units = {"deg/h"},
                 .signals = {axis.signal},
                 .parameters = {{.name = "hs", .unit = "100 uT", .minimum = 0.5, .maximum = 4.0}},
                 .excited_by = "large fields",
                 .confused_with = axis.of("magnetic_linear") +
                                  "; a range limit of the supply, when the commanded field is used",
                 .source = "a magnetisation curve's usual approximation",
                 .limit = axis.of("magnetic_linear"),
                 .hidden_because = axis.needs_three_levels(),
                 .in_challenge = InChallenge{InChallenge::By::kSweep, 2, {{"hs", {0.7, 2.0}}}}},
        .regressor = [axis](const Signals& signals, std::span<const double> inner)
            -> Eigen::MatrixXd { return (axis.field(signals) / inner[0]).tanh(); },
        .other_shapes = [axis](const Effect&, const Signals& signals) -> std::vector<Shape> {
          return {[h = axis.field(signals)](double hs) -> Eigen::MatrixXd {
            return (h / hs).atan().matrix();
          }};
        },
    };
  });
}

}  // namespace fogbench::model::effects
