// A jump of the bias at the time t0. A window that holds the jump sees its share of it.

#include <algorithm>
#include <cmath>

#include "model/effects/function_effect.hpp"

namespace fogbench::model::effects {

Family bias_step() {
  return {{
      .info = {.id = "bias_step",
               .group = EffectInfo::Group::kTime,
               .formula = "1 for time_s >= t0",
               .columns = {""},
               .units = {"deg/h"},
               .signals = {"time_s"},
               .parameters = {{.name = "t0",
                               .unit = "s",
                               .minimum = 0.0,
                               .maximum = 86400.0,
                               .logarithmic = false,
                               .within = "time_s",
                               .instant = true}},
               .excited_by = "a jump while measuring; typically 0.02..0.5 deg/h",
               .confused_with = "earth_rate_projection, where the jump falls on a rotation",
               .source = "bench experience",
               .slow = true,
               .in_challenge = InChallenge{InChallenge::By::kBoth, 13, {{"t0", {3000.0, 8000.0}}}}},
      .regressor = [](const Signals& signals, std::span<const double> inner) -> Eigen::MatrixXd {
        const Signals::View time = signals.signal("time_s");
        const Signals::View duration = signals.signal("duration_s");
        Eigen::VectorXd step(time.size());
        for (Eigen::Index row = 0; row < time.size(); ++row) {
          const double since = time[row] - inner[0];
          step[row] = duration[row] > 0.0 ? std::clamp(since / duration[row] + 0.5, 0.0, 1.0)
                                          : (since >= 0.0 ? 1.0 : 0.0);
          if (std::isnan(since)) step[row] = since;
        }
        return step;
      },
  }};
}

}  // namespace fogbench::model::effects
