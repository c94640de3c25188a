// The Shupe effect of a coil that follows its sensor with a lag.

#include "model/effects/history.hpp"
#include "model/effects/list.hpp"

namespace fogbench::model::effects {

const FunctionEffect& temperature_rate_lagged() {
  static const FunctionEffect effect(
      {.id = "temperature_rate_lagged",
       .formula = "LPF(dT/dt; tau)",
       .columns = {""},
       .units = {"(deg/h)/(degC/h)"},
       .signals = {"temperature_rate_c_per_h", "time_s"},
       .parameters = {{.name = "tau", .unit = "s", .minimum = 30.0, .maximum = 1200.0}},
       .excited_by = "the edges of temperature steps",
       .confused_with = "temperature_acceleration; temperature_rate with a short tau",
       .source =
           "D. M. Shupe, Applied Optics 19 (1980) 654, with the heat conduction of the winding",
       .has_history = true,
       .limit = "temperature_rate"},
      [](const Signals& signals, std::span<const double> inner) -> Eigen::MatrixXd {
        return lag(signals, signals.signal("temperature_rate_c_per_h"), inner[0], Gap::kLinear,
                   LagStart::kEquilibrium, temperature_rates_of_gaps(signals));
      },
      [](const Signals& signals, std::span<const double> inner) -> Eigen::MatrixXd {
        return lag_starts(signals, signals.signal("temperature_rate_c_per_h"), inner[0]);
      });
  return effect;
}

}  // namespace fogbench::model::effects
