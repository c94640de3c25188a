// The coils warm the bench: lagging behind the copper loss of both pairs, the current that nulls
// the ambient field included. They are cold when a run begins: the safe state before it has no
// current.

#include "model/effects/history.hpp"
#include "model/effects/list.hpp"

namespace fogbench::model::effects {

const FunctionEffect& coil_heating() {
  static const FunctionEffect effect(
      {.id = "coil_heating",
       .formula = "LPF(sum of the squared coil currents; tau)",
       .columns = {""},
       .units = {"deg/h per A^2"},
       .signals = {"coil_heat", "time_s"},
       .parameters = {{.name = "tau", .unit = "s", .minimum = 300.0, .maximum = 7200.0}},
       .excited_by = "large fields held long; even in the field and late",
       .confused_with = "magnetic_quadratic_*",
       .source = "copper loss of the coils",
       .has_history = true},
      [](const Signals& signals, std::span<const double> inner) -> Eigen::MatrixXd {
        return lag(signals, signals.signal("coil_heat"), inner[0], Gap::kStepped, LagStart::kZero);
      },
      [](const Signals& signals, std::span<const double> inner) -> Eigen::MatrixXd {
        return lag_starts(signals, signals.signal("coil_heat"), inner[0]);
      });
  return effect;
}

}  // namespace fogbench::model::effects
