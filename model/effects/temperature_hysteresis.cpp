// A memory of the temperature: after a reversal nothing happens until it has moved by twice the
// width.

#include "model/effects/history.hpp"
#include "model/effects/list.hpp"

namespace fogbench::model::effects {

const FunctionEffect& temperature_hysteresis() {
  static const FunctionEffect effect(
      {.id = "temperature_hysteresis",
       .formula = "play_width(t)",
       .columns = {""},
       .units = {"deg/h/degC"},
       .signals = {"temperature_c"},
       .parameters = {{.name = "width", .unit = "degC", .minimum = 0.5, .maximum = 10.0}},
       .excited_by = "heating and cooling branches",
       .confused_with = "drift_linear, without a cooling branch",
       .source = "M. Brokate, J. Sprekels, Hysteresis and Phase Transitions (Springer 1996)",
       .has_history = true,
       .limit = "temperature_linear"},
      [](const Signals& signals, std::span<const double> inner) -> Eigen::MatrixXd {
        return play(signals, excess_temperature(signals), inner[0]);
      },
      [](const Signals& signals, std::span<const double> inner) -> Eigen::MatrixXd {
        return play_starts(signals, excess_temperature(signals), inner[0]);
      });
  return effect;
}

}  // namespace fogbench::model::effects
