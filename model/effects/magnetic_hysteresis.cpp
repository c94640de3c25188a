// The shield remembers: after a reversal nothing happens until the field has moved by twice the
// width.

#include "model/effects/history.hpp"
#include "model/effects/list.hpp"

namespace fogbench::model::effects {

const Family& magnetic_hysteresis() {
  static const Family family = {
      FunctionEffect(
          {.id = "magnetic_hysteresis_x",
           .formula = "play_width(h_x)",
           .columns = {""},
           .units = {"deg/h per 100 uT"},
           .signals = {"field_x_ut"},
           .parameters = {{.name = "width", .unit = "100 uT", .minimum = 0.1, .maximum = 2.0}},
           .excited_by = "up and down branches; a gap at zero field",
           .confused_with = "drift_linear, in a single loop; magnetic_settling_x",
           .source = "M. Brokate, J. Sprekels, Hysteresis and Phase Transitions (Springer 1996)",
           .has_history = true,
           .limit = "magnetic_linear_x"},
          [](const Signals& signals, std::span<const double> inner) -> Eigen::MatrixXd {
            return play(signals, field(signals, "field_x_ut"), inner[0]);
          },
          [](const Signals& signals, std::span<const double> inner) -> Eigen::MatrixXd {
            return play_starts(signals, field(signals, "field_x_ut"), inner[0]);
          }),
      FunctionEffect(
          {.id = "magnetic_hysteresis_y",
           .formula = "play_width(h_y)",
           .columns = {""},
           .units = {"deg/h per 100 uT"},
           .signals = {"field_y_ut"},
           .parameters = {{.name = "width", .unit = "100 uT", .minimum = 0.1, .maximum = 2.0}},
           .excited_by = "up and down branches; a gap at zero field",
           .confused_with = "drift_linear, in a single loop; magnetic_settling_y",
           .source = "M. Brokate, J. Sprekels, Hysteresis and Phase Transitions (Springer 1996)",
           .has_history = true,
           .limit = "magnetic_linear_y"},
          [](const Signals& signals, std::span<const double> inner) -> Eigen::MatrixXd {
            return play(signals, field(signals, "field_y_ut"), inner[0]);
          },
          [](const Signals& signals, std::span<const double> inner) -> Eigen::MatrixXd {
            return play_starts(signals, field(signals, "field_y_ut"), inner[0]);
          }),
      FunctionEffect(
          {.id = "magnetic_hysteresis_z",
           .formula = "play_width(h_z)",
           .columns = {""},
           .units = {"deg/h per 100 uT"},
           .signals = {"field_z_ut"},
           .parameters = {{.name = "width", .unit = "100 uT", .minimum = 0.1, .maximum = 2.0}},
           .excited_by = "up and down branches; a gap at zero field",
           .confused_with = "drift_linear, in a single loop; magnetic_settling_z",
           .source = "M. Brokate, J. Sprekels, Hysteresis and Phase Transitions (Springer 1996)",
           .has_history = true,
           .limit = "magnetic_linear_z"},
          [](const Signals& signals, std::span<const double> inner) -> Eigen::MatrixXd {
            return play(signals, field(signals, "field_z_ut"), inner[0]);
          },
          [](const Signals& signals, std::span<const double> inner) -> Eigen::MatrixXd {
            return play_starts(signals, field(signals, "field_z_ut"), inner[0]);
          })};
  return family;
}

}  // namespace fogbench::model::effects
