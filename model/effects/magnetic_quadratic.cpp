// An error that is even in the field.

#include "model/effects/list.hpp"

namespace fogbench::model::effects {

const Family& magnetic_quadratic() {
  static const Family family = {
      FunctionEffect({.id = "magnetic_quadratic_x",
                      .formula = "h_x^2",
                      .columns = {""},
                      .units = {"deg/h per (100 uT)^2"},
                      .signals = {"field_x_ut"},
                      .parameters = {},
                      .excited_by = "both signs of the field",
                      .confused_with = "coil_heating",
                      .source = "second term of the expansion in the field"},
                     [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
                       return field(signals, "field_x_ut").square();
                     }),
      FunctionEffect({.id = "magnetic_quadratic_y",
                      .formula = "h_y^2",
                      .columns = {""},
                      .units = {"deg/h per (100 uT)^2"},
                      .signals = {"field_y_ut"},
                      .parameters = {},
                      .excited_by = "both signs of the field",
                      .confused_with = "coil_heating",
                      .source = "second term of the expansion in the field"},
                     [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
                       return field(signals, "field_y_ut").square();
                     }),
      FunctionEffect({.id = "magnetic_quadratic_z",
                      .formula = "h_z^2",
                      .columns = {""},
                      .units = {"deg/h per (100 uT)^2"},
                      .signals = {"field_z_ut"},
                      .parameters = {},
                      .excited_by = "both signs of the field",
                      .confused_with = "coil_heating",
                      .source = "second term of the expansion in the field"},
                     [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
                       return field(signals, "field_z_ut").square();
                     })};
  return family;
}

}  // namespace fogbench::model::effects
