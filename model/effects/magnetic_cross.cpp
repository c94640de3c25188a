// An error in proportion to the product of the fields along two axes.

#include "model/effects/list.hpp"

namespace fogbench::model::effects {

const Family& magnetic_cross() {
  static const Family family = {
      FunctionEffect(
          {.id = "magnetic_cross_xy",
           .formula = "h_x h_y",
           .columns = {""},
           .units = {"deg/h per (100 uT)^2"},
           .signals = {"field_x_ut", "field_y_ut"},
           .parameters = {},
           .excited_by = "two axes energised together, never by sweeps of one axis",
           .confused_with = "magnetic_quadratic_*, where the field is turned between the axes",
           .source = "second term of the expansion in the field"},
          [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
            return field(signals, "field_x_ut") * field(signals, "field_y_ut");
          }),
      FunctionEffect(
          {.id = "magnetic_cross_yz",
           .formula = "h_y h_z",
           .columns = {""},
           .units = {"deg/h per (100 uT)^2"},
           .signals = {"field_y_ut", "field_z_ut"},
           .parameters = {},
           .excited_by = "two axes energised together, never by sweeps of one axis",
           .confused_with = "magnetic_quadratic_*, where the field is turned between the axes",
           .source = "second term of the expansion in the field"},
          [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
            return field(signals, "field_y_ut") * field(signals, "field_z_ut");
          }),
      FunctionEffect(
          {.id = "magnetic_cross_zx",
           .formula = "h_z h_x",
           .columns = {""},
           .units = {"deg/h per (100 uT)^2"},
           .signals = {"field_z_ut", "field_x_ut"},
           .parameters = {},
           .excited_by = "two axes energised together, never by sweeps of one axis",
           .confused_with = "magnetic_quadratic_*, where the field is turned between the axes",
           .source = "second term of the expansion in the field"},
          [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
            return field(signals, "field_z_ut") * field(signals, "field_x_ut");
          })};
  return family;
}

}  // namespace fogbench::model::effects
