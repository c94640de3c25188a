// The Faraday effect: an error in proportion to the field along one axis, h in units of 100 uT.

#include "model/effects/list.hpp"

namespace fogbench::model::effects {

const Family& magnetic_linear() {
  static const Family family = {
      FunctionEffect(
          {.id = "magnetic_linear_x",
           .formula = "h_x",
           .columns = {""},
           .units = {"deg/h per 100 uT"},
           .signals = {"field_x_ut"},
           .parameters = {},
           .excited_by = "coils along x; typically 0.005..3 deg/h per 100 uT",
           .confused_with = "magnetic_temperature_x, at one temperature",
           .source =
               "K. Hotate, K. Tabe, Applied Optics 25 (1986) 1086: Faraday effect in a fibre coil"},
          [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
            return field(signals, "field_x_ut");
          }),
      FunctionEffect(
          {.id = "magnetic_linear_y",
           .formula = "h_y",
           .columns = {""},
           .units = {"deg/h per 100 uT"},
           .signals = {"field_y_ut"},
           .parameters = {},
           .excited_by = "coils along y; typically 0.005..3 deg/h per 100 uT",
           .confused_with = "magnetic_temperature_y, at one temperature",
           .source =
               "K. Hotate, K. Tabe, Applied Optics 25 (1986) 1086: Faraday effect in a fibre coil"},
          [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
            return field(signals, "field_y_ut");
          }),
      FunctionEffect(
          {.id = "magnetic_linear_z",
           .formula = "h_z",
           .columns = {""},
           .units = {"deg/h per 100 uT"},
           .signals = {"field_z_ut"},
           .parameters = {},
           .excited_by = "coils along z; typically 0.005..3 deg/h per 100 uT",
           .confused_with = "magnetic_temperature_z, at one temperature",
           .source =
               "K. Hotate, K. Tabe, Applied Optics 25 (1986) 1086: Faraday effect in a fibre coil"},
          [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
            return field(signals, "field_z_ut");
          })};
  return family;
}

}  // namespace fogbench::model::effects
