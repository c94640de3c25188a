// A Shupe effect whose size depends on the temperature itself.

#include "model/effects/list.hpp"

namespace fogbench::model::effects {

const FunctionEffect& temperature_rate_cross() {
  static const FunctionEffect effect(
      {.id = "temperature_rate_cross",
       .formula = "t dT/dt",
       .columns = {""},
       .units = {"(deg/h)/(degC^2/h)"},
       .signals = {"temperature_c", "temperature_rate_c_per_h"},
       .parameters = {},
       .excited_by = "ramps at several temperatures",
       .confused_with = "temperature_rate",
       .source =
           "D. M. Shupe, Applied Optics 19 (1980) 654, with temperature-dependent fibre data"},
      [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
        return excess_temperature(signals) * signals.signal("temperature_rate_c_per_h").array();
      });
  return effect;
}

}  // namespace fogbench::model::effects
