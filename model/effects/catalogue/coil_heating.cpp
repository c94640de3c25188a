// The coils warm the bench: lagging behind the copper loss of both pairs, the current that nulls
// the ambient field included. They are cold when a run begins: the safe state before it has no
// current.
//
// In no challenge: no field is held long enough.

#include "model/effects/function_effect.hpp"
#include "model/effects/history.hpp"

namespace fogbench::model::effects {

Family coil_heating() {
  return {{
      .info = {.id = "coil_heating",
               .group = EffectInfo::Group::kBench,
               .formula = "LPF(sum of the squared coil currents; tau)",
               .columns = {""},
               .units = {"deg/h per A^2"},
               .signals = {"coil_heat", "time_s"},
               .parameters = {{.name = "tau", .unit = "s", .minimum = 300.0, .maximum = 7200.0}},
               .excited_by = "large fields held long; even in the field and late",
               .confused_with = "magnetic_quadratic_*",
               .source = "copper loss of the coils",
               .has_history = true,
               .slow = true},
      .regressor = [](const Signals& signals, std::span<const double> inner) -> Eigen::MatrixXd {
        return lag(signals, signals.signal("coil_heat"), inner[0], Gap::kStepped, LagStart::kZero);
      },
      .starts = [](const Signals& signals, std::span<const double> inner) -> Eigen::MatrixXd {
        return lag_starts(signals, signals.signal("coil_heat"), inner[0]);
      },
      // The copper warms the bench, and the bench the gyro: two equal poles.
      .other_shapes = [](const Effect&, const Signals& signals) -> std::vector<Shape> {
        return {[&signals](double tau) -> Eigen::MatrixXd {
          const Eigen::VectorXd bench =
              lag(signals, signals.signal("coil_heat"), 0.5 * tau, Gap::kStepped, LagStart::kZero);
          return lag(signals, bench, 0.5 * tau, Gap::kLinear, LagStart::kZero);
        }};
      },
  }};
}

}  // namespace fogbench::model::effects
