// The Shupe effect of a coil that follows its sensor with a lag.

#include "model/effects/function_effect.hpp"
#include "model/effects/history.hpp"
#include "model/effects/rate_of_windows.hpp"

namespace fogbench::model::effects {

Family temperature_rate_lagged() {
  return {{
      .info = {.id = "temperature_rate_lagged",
               .group = EffectInfo::Group::kTemperature,
               .formula = "LPF(dT/dt; tau)",
               .columns = {""},
               .units = {"(deg/h)/(degC/h)"},
               .signals = {"temperature_rate_c_per_h", "time_s"},
               .parameters = {{.name = "tau", .unit = "s", .minimum = 30.0, .maximum = 1200.0}},
               .excited_by = "the edges of temperature steps",
               .confused_with = "temperature_acceleration; temperature_rate with a short tau",
               .source = "D. M. Shupe, Applied Optics 19 (1980) 654, with the heat conduction of "
                         "the winding",
               .has_history = true,
               .limit = "temperature_rate",
               .in_challenge =
                   InChallenge{InChallenge::By::kHeating, 7, {{"tau", {200.0, 1200.0}}}}},
      .regressor = [](const Signals& signals, std::span<const double> inner) -> Eigen::MatrixXd {
        return lagged_rate(signals, inner[0]);
      },
      .starts = [](const Signals& signals, std::span<const double> inner) -> Eigen::MatrixXd {
        return lag_starts(signals, signals.signal("temperature_rate_c_per_h"), inner[0]);
      },
      .other_shapes = [](const Effect& own, const Signals& signals) -> std::vector<Shape> {
        std::vector<Shape> out = with_rate_of_windows(own, signals);
        if (out.empty()) return out;
        out.push_back([&signals](double tau) -> Eigen::MatrixXd {
          return lagged_rate_of_means(signals, tau);
        });
        return out;
      },
  }};
}

}  // namespace fogbench::model::effects
