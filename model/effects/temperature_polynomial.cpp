// The settled temperature error, a polynomial in t = T - T_ref.

#include "model/effects/list.hpp"

namespace fogbench::model::effects {

const Family& temperature_polynomial() {
  static const Family family = {
      FunctionEffect(
          {.id = "temperature_linear",
           .formula = "t",
           .columns = {""},
           .units = {"deg/h/degC"},
           .signals = {"temperature_c"},
           .parameters = {},
           .excited_by = "plateaus at several temperatures",
           .confused_with =
               "temperature_quadratic and temperature_cubic over a short range; heater_power",
           .source = "The acceptance procedure: polynomial of the temperature error"},
          [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
            return excess_temperature(signals);
          }),
      FunctionEffect({.id = "temperature_quadratic",
                      .formula = "t^2",
                      .columns = {""},
                      .units = {"deg/h/degC^2"},
                      .signals = {"temperature_c"},
                      .parameters = {},
                      .excited_by = "plateaus at several temperatures",
                      .confused_with = "temperature_linear over a short range",
                      .source = "The acceptance procedure: polynomial of the temperature error"},
                     [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
                       return excess_temperature(signals).square();
                     }),
      FunctionEffect(
          {.id = "temperature_cubic",
           .formula = "t^3",
           .columns = {""},
           .units = {"deg/h/degC^3"},
           .signals = {"temperature_c"},
           .parameters = {},
           .excited_by = "plateaus at four temperatures or more",
           .confused_with = "temperature_linear, temperature_quadratic over a short range",
           .source = "The acceptance procedure: polynomial of the temperature error"},
          [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
            return excess_temperature(signals).cube();
          })};
  return family;
}

}  // namespace fogbench::model::effects
