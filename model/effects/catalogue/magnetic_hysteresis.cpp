// The shield remembers: after a reversal nothing happens until the field has moved by twice the
// width.

#include "model/effects/function_effect.hpp"
#include "model/effects/history.hpp"

namespace fogbench::model::effects {

Family magnetic_hysteresis() {
  return along_each_axis("magnetic_hysteresis", [](const Axis& axis) -> FunctionParts {
    return {
        .info =
            {.group = EffectInfo::Group::kField,
             .formula = "play_width(" + axis.h + ")",
             .columns = {""},
             .units = {"deg/h per 100 uT"},
             .signals = {axis.signal},
             .parameters = {{.name = "width", .unit = "100 uT", .minimum = 0.1, .maximum = 2.0}},
             .excited_by = "up and down branches; a gap at zero field",
             .confused_with = "drift_linear, in a single loop; " + axis.of("magnetic_settling"),
             .source = "M. Brokate, J. Sprekels, Hysteresis and Phase Transitions (Springer "
                       "1996)",
             .has_history = true,
             .limit = axis.of("magnetic_linear"),
             .hidden_because = axis.needs_three_levels(),
             // Narrower ones look like a settling where a level has one window.
             .in_challenge = InChallenge{InChallenge::By::kSweep, 3, {{"width", {0.6, 1.5}}}}},
        .regressor = [axis](const Signals& signals, std::span<const double> inner)
            -> Eigen::MatrixXd { return play(signals, axis.field(signals), inner[0]); },
        .starts = [axis](const Signals& signals, std::span<const double> inner) -> Eigen::MatrixXd {
          return play_starts(signals, axis.field(signals), inner[0]);
        },
        .other_shapes = [axis](const Effect&, const Signals& signals) -> std::vector<Shape> {
          const Eigen::VectorXd h = axis.field(signals);
          return {[&signals, h](double width) -> Eigen::MatrixXd {
                    return relaxing_loop(signals, h, width);
                  },
                  [&signals, h](double width) -> Eigen::MatrixXd {
                    return path_lag(signals, h, width);
                  }};
        },
    };
  });
}

}  // namespace fogbench::model::effects
