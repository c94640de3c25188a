// The Shupe effect: a fibre coil whose temperature changes.

#include "model/effects/list.hpp"

namespace fogbench::model::effects {

const FunctionEffect& temperature_rate() {
  static const FunctionEffect effect(
      {.id = "temperature_rate",
       .formula = "dT/dt",
       .columns = {""},
       .units = {"(deg/h)/(degC/h)"},
       .signals = {"temperature_rate_c_per_h"},
       .parameters = {},
       .excited_by = "ramps; typically 0.05..3 (deg/h)/(degC/min)",
       .confused_with = "temperature_gradient; the lag of the sensor",
       .source = "D. M. Shupe, Applied Optics 19 (1980) 654"},
      [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
        return signals.signal("temperature_rate_c_per_h");
      });
  return effect;
}

}  // namespace fogbench::model::effects
