// The sensitivity to the field changes with the temperature.

#include "model/effects/list.hpp"

namespace fogbench::model::effects {

const Family& magnetic_temperature() {
  static const Family family = {
      FunctionEffect({.id = "magnetic_temperature_x",
                      .formula = "h_x t",
                      .columns = {""},
                      .units = {"deg/h/degC per 100 uT"},
                      .signals = {"field_x_ut", "temperature_c"},
                      .parameters = {},
                      .excited_by = "a sweep of x repeated at a second temperature",
                      .confused_with = "magnetic_linear_x",
                      .source = "the Verdet constant's dependence on temperature"},
                     [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
                       return field(signals, "field_x_ut") * excess_temperature(signals);
                     }),
      FunctionEffect({.id = "magnetic_temperature_y",
                      .formula = "h_y t",
                      .columns = {""},
                      .units = {"deg/h/degC per 100 uT"},
                      .signals = {"field_y_ut", "temperature_c"},
                      .parameters = {},
                      .excited_by = "a sweep of y repeated at a second temperature",
                      .confused_with = "magnetic_linear_y",
                      .source = "the Verdet constant's dependence on temperature"},
                     [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
                       return field(signals, "field_y_ut") * excess_temperature(signals);
                     }),
      FunctionEffect({.id = "magnetic_temperature_z",
                      .formula = "h_z t",
                      .columns = {""},
                      .units = {"deg/h/degC per 100 uT"},
                      .signals = {"field_z_ut", "temperature_c"},
                      .parameters = {},
                      .excited_by = "a sweep of z repeated at a second temperature",
                      .confused_with = "magnetic_linear_z",
                      .source = "the Verdet constant's dependence on temperature"},
                     [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
                       return field(signals, "field_z_ut") * excess_temperature(signals);
                     })};
  return family;
}

}  // namespace fogbench::model::effects
