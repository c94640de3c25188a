// The error overshoots at a step of the field and dies away: the field minus its lag.
//
// In no challenge: of one window a level it makes a hysteresis of half a level's step, to 4..14 %
// of its size.

#include "model/effects/function_effect.hpp"
#include "model/effects/history.hpp"

namespace fogbench::model::effects {

Family magnetic_settling() {
  return along_each_axis("magnetic_settling", [](const Axis& axis) -> FunctionParts {
    return {
        .info = {.group = EffectInfo::Group::kField,
                 .formula =
                     "sum of the steps of " + axis.h + " times exp(-time since the step / tau)",
                 .columns = {""},
                 .units = {"deg/h per 100 uT"},
                 .signals = {axis.signal, "time_s"},
                 .parameters = {{.name = "tau", .unit = "s", .minimum = 5.0, .maximum = 300.0}},
                 .excited_by = "every step of the field",
                 .confused_with = axis.of("magnetic_hysteresis") + ", in averaged points",
                 .source = "eddy currents and the after-effect of a shield",
                 .has_history = true,
                 .hidden_because = axis.needs_three_levels()},
        .regressor = [axis](const Signals& signals,
                            std::span<const double> inner) -> Eigen::MatrixXd {
          const Eigen::VectorXd h = axis.field(signals);
          return h - lag(signals, h, inner[0], Gap::kStepped);
        },
        .starts = [axis](const Signals& signals, std::span<const double> inner) -> Eigen::MatrixXd {
          return lag_starts(signals, axis.field(signals), inner[0]);
        },
    };
  });
}

}  // namespace fogbench::model::effects
