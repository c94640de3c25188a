// An error that is odd in the field and flattens: the shield, or the core of a sensor, saturates.

#include "model/effects/list.hpp"

namespace fogbench::model::effects {

const Family& magnetic_saturation() {
  static const Family family = {
      FunctionEffect(
          {.id = "magnetic_saturation_x",
           .formula = "tanh(h_x / hs)",
           .columns = {""},
           .units = {"deg/h"},
           .signals = {"field_x_ut"},
           .parameters = {{.name = "hs", .unit = "100 uT", .minimum = 0.5, .maximum = 4.0}},
           .excited_by = "large fields",
           .confused_with =
               "magnetic_linear_x; a range limit of the supply, when the commanded field is used",
           .source = "a magnetisation curve's usual approximation",
           .limit = "magnetic_linear_x"},
          [](const Signals& signals, std::span<const double> inner) -> Eigen::MatrixXd {
            return (field(signals, "field_x_ut") / inner[0]).tanh();
          }),
      FunctionEffect(
          {.id = "magnetic_saturation_y",
           .formula = "tanh(h_y / hs)",
           .columns = {""},
           .units = {"deg/h"},
           .signals = {"field_y_ut"},
           .parameters = {{.name = "hs", .unit = "100 uT", .minimum = 0.5, .maximum = 4.0}},
           .excited_by = "large fields",
           .confused_with =
               "magnetic_linear_y; a range limit of the supply, when the commanded field is used",
           .source = "a magnetisation curve's usual approximation",
           .limit = "magnetic_linear_y"},
          [](const Signals& signals, std::span<const double> inner) -> Eigen::MatrixXd {
            return (field(signals, "field_y_ut") / inner[0]).tanh();
          }),
      FunctionEffect(
          {.id = "magnetic_saturation_z",
           .formula = "tanh(h_z / hs)",
           .columns = {""},
           .units = {"deg/h"},
           .signals = {"field_z_ut"},
           .parameters = {{.name = "hs", .unit = "100 uT", .minimum = 0.5, .maximum = 4.0}},
           .excited_by = "large fields",
           .confused_with =
               "magnetic_linear_z; a range limit of the supply, when the commanded field is used",
           .source = "a magnetisation curve's usual approximation",
           .limit = "magnetic_linear_z"},
          [](const Signals& signals, std::span<const double> inner) -> Eigen::MatrixXd {
            return (field(signals, "field_z_ut") / inner[0]).tanh();
          })};
  return family;
}

}  // namespace fogbench::model::effects
