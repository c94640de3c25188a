// A drift in proportion to the time since the run began.

#include "model/effects/list.hpp"

namespace fogbench::model::effects {

const FunctionEffect& drift_linear() {
  static const FunctionEffect effect(
      {.id = "drift_linear",
       .formula = "(time_s - time_s of the run's first row) / 1 h",
       .columns = {""},
       .units = {"deg/h/h"},
       .signals = {"time_since_start_s"},
       .parameters = {},
       .excited_by = "long runs",
       .confused_with = "warm_up with a long tau; random walk",
       .source = "IEEE Std 952, rate ramp"},
      [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
        return signals.signal("time_since_start_s") / 3600.0;
      });
  return effect;
}

}  // namespace fogbench::model::effects
