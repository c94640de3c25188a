// The Shupe effect: a fibre coil whose temperature changes.

#include "model/effects/function_effect.hpp"
#include "model/effects/history.hpp"
#include "model/effects/rate_of_windows.hpp"

namespace fogbench::model::effects {
namespace {

/// A lag of half a window lies within what averaging leaves open: the instants at which a logger
/// takes the temperatures of a window's two ends.
std::vector<Shape> within_a_window(const Effect& own, const Signals& signals) {
  std::vector<Shape> out = with_rate_of_windows(own, signals);
  if (out.empty()) return out;
  out.push_back([&signals](double) -> Eigen::MatrixXd {
    return lagged_rate(signals, 0.5 * usual_duration_s(signals));
  });
  return out;
}

}  // namespace

Family temperature_rate() {
  return {{
      .info = {.id = "temperature_rate",
               .group = EffectInfo::Group::kTemperature,
               .formula = "dT/dt",
               .columns = {""},
               .units = {"(deg/h)/(degC/h)"},
               .signals = {"temperature_rate_c_per_h"},
               .excited_by = "ramps; typically 0.05..3 (deg/h)/(degC/min)",
               .confused_with = "temperature_gradient; the lag of the sensor",
               .source = "D. M. Shupe, Applied Optics 19 (1980) 654",
               .like_a_late_thermometer = true,
               .elementary_in = "temperature_rate_c_per_h",
               .in_challenge = InChallenge{InChallenge::By::kHeating, 6}},
      .regressor = [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
        return signals.signal("temperature_rate_c_per_h");
      },
      .other_shapes = within_a_window,
  }};
}

}  // namespace fogbench::model::effects
