// The part of the error that follows the change of the temperature rate.

#include "model/effects/list.hpp"

namespace fogbench::model::effects {

const FunctionEffect& temperature_acceleration() {
  static const FunctionEffect effect(
      {.id = "temperature_acceleration",
       .formula = "d2T/dt2",
       .columns = {""},
       .units = {"(deg/h)/(degC/h^2)"},
       .signals = {"temperature_acceleration_c_per_h2"},
       .parameters = {},
       .excited_by = "the edges of temperature steps",
       .confused_with = "temperature_rate_lagged",
       .source = "first term of the expansion of a lag"},
      [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
        return signals.signal("temperature_acceleration_c_per_h2");
      });
  return effect;
}

}  // namespace fogbench::model::effects
