// The error overshoots at a step of the field and dies away: the field minus its lag.

#include "model/effects/history.hpp"
#include "model/effects/list.hpp"

namespace fogbench::model::effects {

const Family& magnetic_settling() {
  static const Family family = {
      FunctionEffect(
          {.id = "magnetic_settling_x",
           .formula = "sum of the steps of h_x times exp(-time since the step / tau)",
           .columns = {""},
           .units = {"deg/h per 100 uT"},
           .signals = {"field_x_ut", "time_s"},
           .parameters = {{.name = "tau", .unit = "s", .minimum = 5.0, .maximum = 300.0}},
           .excited_by = "every step of the field",
           .confused_with = "magnetic_hysteresis_x, in averaged points",
           .source = "eddy currents and the after-effect of a shield",
           .has_history = true},
          [](const Signals& signals, std::span<const double> inner) -> Eigen::MatrixXd {
            const Eigen::VectorXd h = field(signals, "field_x_ut");
            return h - lag(signals, h, inner[0], Gap::kStepped);
          },
          [](const Signals& signals, std::span<const double> inner) -> Eigen::MatrixXd {
            return lag_starts(signals, field(signals, "field_x_ut"), inner[0]);
          }),
      FunctionEffect(
          {.id = "magnetic_settling_y",
           .formula = "sum of the steps of h_y times exp(-time since the step / tau)",
           .columns = {""},
           .units = {"deg/h per 100 uT"},
           .signals = {"field_y_ut", "time_s"},
           .parameters = {{.name = "tau", .unit = "s", .minimum = 5.0, .maximum = 300.0}},
           .excited_by = "every step of the field",
           .confused_with = "magnetic_hysteresis_y, in averaged points",
           .source = "eddy currents and the after-effect of a shield",
           .has_history = true},
          [](const Signals& signals, std::span<const double> inner) -> Eigen::MatrixXd {
            const Eigen::VectorXd h = field(signals, "field_y_ut");
            return h - lag(signals, h, inner[0], Gap::kStepped);
          },
          [](const Signals& signals, std::span<const double> inner) -> Eigen::MatrixXd {
            return lag_starts(signals, field(signals, "field_y_ut"), inner[0]);
          }),
      FunctionEffect(
          {.id = "magnetic_settling_z",
           .formula = "sum of the steps of h_z times exp(-time since the step / tau)",
           .columns = {""},
           .units = {"deg/h per 100 uT"},
           .signals = {"field_z_ut", "time_s"},
           .parameters = {{.name = "tau", .unit = "s", .minimum = 5.0, .maximum = 300.0}},
           .excited_by = "every step of the field",
           .confused_with = "magnetic_hysteresis_z, in averaged points",
           .source = "eddy currents and the after-effect of a shield",
           .has_history = true},
          [](const Signals& signals, std::span<const double> inner) -> Eigen::MatrixXd {
            const Eigen::VectorXd h = field(signals, "field_z_ut");
            return h - lag(signals, h, inner[0], Gap::kStepped);
          },
          [](const Signals& signals, std::span<const double> inner) -> Eigen::MatrixXd {
            return lag_starts(signals, field(signals, "field_z_ut"), inner[0]);
          })};
  return family;
}

}  // namespace fogbench::model::effects
