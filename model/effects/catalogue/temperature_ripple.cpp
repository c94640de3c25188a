// Interference: an error that repeats with the temperature.

#include <cmath>
#include <numbers>
#include <set>

#include "model/effects/function_effect.hpp"

namespace fogbench::model::effects {
namespace {

std::string too_few_temperatures(const Signals& signals) {
  constexpr std::size_t kFewest = 8;
  std::set<long> degrees;
  for (const double t : signals.signal("temperature_c")) {
    if (std::isfinite(t)) degrees.insert(std::lround(t));
  }
  return degrees.size() < kFewest ? "temperature_c takes too few values to show a period" : "";
}

}  // namespace

Family temperature_ripple() {
  return {{
      .info = {.id = "temperature_ripple",
               .group = EffectInfo::Group::kTemperature,
               .formula = "sin, cos of 2 pi T / period",
               .columns = {"sin", "cos"},
               .units = {"deg/h", "deg/h"},
               .signals = {"temperature_c"},
               .parameters = {{.name = "period",
                               .unit = "degC",
                               .minimum = 2.0,
                               .maximum = 10.0,
                               .period_of = "temperature_c"}},
               .excited_by = "a fine temperature grid; a grid of 5 degC hides periods that "
                             "divide it",
               .confused_with = "polynomial terms",
               .source = "H. C. Lefevre, The Fiber-Optic Gyroscope (Artech House): spurious "
                         "interferometers",
               .hidden_because = too_few_temperatures,
               .in_challenge = InChallenge{InChallenge::By::kHeating,
                                           11,
                                           {{"period", {4.0, 10.0}}, {"phase_deg", {0.0, 360.0}}}}},
      .regressor = [](const Signals& signals, std::span<const double> inner) -> Eigen::MatrixXd {
        const Eigen::ArrayXd angle =
            2.0 * std::numbers::pi / inner[0] * signals.signal("temperature_c").array();
        Eigen::MatrixXd columns(angle.size(), 2);
        columns << angle.sin(), angle.cos();
        return columns;
      },
  }};
}

}  // namespace fogbench::model::effects
