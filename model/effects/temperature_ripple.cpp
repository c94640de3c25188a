// Interference: an error that repeats with the temperature.

#include <numbers>

#include "model/effects/list.hpp"

namespace fogbench::model::effects {

const FunctionEffect& temperature_ripple() {
  static const FunctionEffect effect(
      {.id = "temperature_ripple",
       .formula = "sin, cos of 2 pi T / period",
       .columns = {"sin", "cos"},
       .units = {"deg/h", "deg/h"},
       .signals = {"temperature_c"},
       .parameters = {{.name = "period", .unit = "degC", .minimum = 2.0, .maximum = 10.0}},
       .excited_by = "a fine temperature grid; a grid of 5 degC hides periods that divide it",
       .confused_with = "polynomial terms",
       .source =
           "H. C. Lefevre, The Fiber-Optic Gyroscope (Artech House): spurious interferometers"},
      [](const Signals& signals, std::span<const double> inner) -> Eigen::MatrixXd {
        const Eigen::ArrayXd angle =
            2.0 * std::numbers::pi / inner[0] * signals.signal("temperature_c").array();
        Eigen::MatrixXd columns(angle.size(), 2);
        columns << angle.sin(), angle.cos();
        return columns;
      });
  return effect;
}

}  // namespace fogbench::model::effects
