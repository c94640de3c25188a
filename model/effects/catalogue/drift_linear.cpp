// A drift in proportion to the time since the run began.

#include "model/effects/function_effect.hpp"

namespace fogbench::model::effects {

Family drift_linear() {
  return {{
      .info = {.id = "drift_linear",
               .group = EffectInfo::Group::kTime,
               .formula = "(time_s - time_s of the run's first row) / 1 h",
               .columns = {""},
               .units = {"deg/h/h"},
               .signals = {"time_since_start_s"},
               .excited_by = "long runs",
               .confused_with = "warm_up with a long tau; random walk",
               .source = "IEEE Std 952, rate ramp",
               .slow = true,
               .in_challenge = InChallenge{InChallenge::By::kBoth, 14}},
      .regressor = [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
        return signals.signal("time_since_start_s") / 3600.0;
      },
  }};
}

}  // namespace fogbench::model::effects
