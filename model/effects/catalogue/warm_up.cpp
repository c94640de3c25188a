// The transient after power-on, averaged over each window: the mean of exp(-s/tau) over a window of
// duration d about the time t is exp(-t/tau) sinh(x)/x with x = d / (2 tau).

#include <cmath>

#include "model/effects/function_effect.hpp"

namespace fogbench::model::effects {

Family warm_up() {
  return {{
      .info = {.id = "warm_up",
               .group = EffectInfo::Group::kTime,
               .formula = "exp(-time since power-on / tau)",
               .columns = {""},
               .units = {"deg/h"},
               .signals = {"time_since_power_on_s"},
               .parameters = {{.name = "tau", .unit = "s", .minimum = 300.0, .maximum = 7200.0}},
               .excited_by = "the first hour after power-on; typically 0.1..2 deg/h",
               .confused_with = "temperature_rate; drift_linear with a long tau",
               .source = "bench experience: electronics and light source warming up",
               .slow = true,
               .in_challenge = InChallenge{InChallenge::By::kBoth, 15, {{"tau", {900.0, 3600.0}}}}},
      .regressor = [](const Signals& signals, std::span<const double> inner) -> Eigen::MatrixXd {
        const Signals::View time = signals.signal("time_since_power_on_s");
        const Signals::View duration = signals.signal("duration_s");
        Eigen::VectorXd decay = (-time / inner[0]).array().exp();
        for (Eigen::Index row = 0; row < decay.size(); ++row) {
          const double x = duration[row] / (2.0 * inner[0]);
          if (x > 1e-6) decay[row] *= std::sinh(x) / x;
        }
        return decay;
      },
  }};
}

}  // namespace fogbench::model::effects
