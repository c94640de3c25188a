// A Shupe effect whose size depends on the temperature itself.

#include "model/effects/function_effect.hpp"
#include "model/effects/rate_of_windows.hpp"

namespace fogbench::model::effects {

Family temperature_rate_cross() {
  return {{
      .info = {.id = "temperature_rate_cross",
               .group = EffectInfo::Group::kTemperature,
               .formula = "t dT/dt",
               .columns = {""},
               .units = {"(deg/h)/(degC^2/h)"},
               .signals = {"temperature_c", "temperature_rate_c_per_h"},
               .excited_by = "ramps at several temperatures",
               .confused_with = "temperature_rate",
               .source = "D. M. Shupe, Applied Optics 19 (1980) 654, with temperature-dependent "
                         "fibre data",
               .elementary_in = "temperature_rate_c_per_h",
               .in_challenge = InChallenge{InChallenge::By::kHeating, 8}},
      .regressor = [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
        return excess_temperature(signals) * signals.signal("temperature_rate_c_per_h").array();
      },
      .other_shapes = with_rate_of_windows,
  }};
}

}  // namespace fogbench::model::effects
