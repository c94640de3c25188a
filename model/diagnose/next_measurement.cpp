#include "model/diagnose/next_measurement.hpp"

#include <algorithm>
#include <string_view>

namespace fogbench::model {
namespace {

/// An experiment that the bench can do, and the effects that it excites as nothing else does.
struct Experiment {
  std::string_view action;
  std::vector<std::string_view> tells;
};

const std::vector<Experiment>& experiments() {
  static const std::vector<Experiment> kExperiments = {
      {"record an hour at rest (procedure static-record) and give it as --quiet, or repeat the run "
       "on another day: a random walk does not repeat",
       {"random_walk"}},
      {"add a cooling branch (thermostat-steps with cooling): hysteresis turns its sign, warm-up "
       "and drift do not",
       {"temperature_hysteresis"}},
      {"switch the heater off for 60 s at a constant temperature: only heater pick-up follows at "
       "once",
       {"heater_power"}},
      {"heat once with the boost and once with the normal heater at the same rate: the gradient "
       "differs, the rate does not",
       {"temperature_gradient"}},
      {"ramp at two different rates and look at the edges: a lag shows in the seconds after the "
       "ramp stops",
       {"temperature_rate", "temperature_rate_lagged", "temperature_acceleration"}},
      {"ramp at several temperatures: only the cross term's slope changes with temperature",
       {"temperature_rate_cross"}},
      {"repeat the first axis at azimuth 90 deg: the Earth's rate follows the azimuth, a step does "
       "not",
       {"earth_rate_projection"}},
      {"step the temperature by 1 degC: a ripple repeats, a polynomial does not",
       {"temperature_ripple", "temperature_cubic", "temperature_quadratic"}},
      {"average each field point in two windows, early and late: settling fades, hysteresis stays",
       {"magnetic_settling_x", "magnetic_settling_y", "magnetic_settling_z"}},
      {"sweep with small and with large end fields: a loop's width grows with the field, a "
       "saturation curve is retraced",
       {"magnetic_hysteresis_x", "magnetic_hysteresis_y", "magnetic_hysteresis_z",
        "magnetic_saturation_x", "magnetic_saturation_y", "magnetic_saturation_z"}},
      {"hold +300 uT and -300 uT for half an hour each: coil heating grows with time, a quadratic "
       "term does not",
       {"coil_heating", "magnetic_quadratic_x", "magnetic_quadratic_y", "magnetic_quadratic_z"}},
      {"repeat the sweep at a second thermostat temperature",
       {"magnetic_temperature_x", "magnetic_temperature_y", "magnetic_temperature_z"}},
      {"energise both coil pairs together, at all four sign combinations",
       {"magnetic_cross_xy", "magnetic_cross_yz", "magnetic_cross_zx"}},
      {"repeat the first point at the end, and once run the list in reverse order: drift follows "
       "the clock, not the set point",
       {"drift_linear", "bias_step", "warm_up", "ambient_temperature"}},
      {"demagnetise the shield and repeat the sweep",
       {"magnetic_linear_x", "magnetic_linear_y", "magnetic_linear_z"}},
  };
  return kExperiments;
}

}  // namespace

std::vector<NextMeasurement> next_measurements(
    const std::vector<std::vector<std::string>>& ambiguous,
    const std::vector<NotTestable>& not_testable) {
  std::vector<NextMeasurement> out;
  for (const auto& set : ambiguous) {
    for (const Experiment& experiment : experiments()) {
      // An experiment that touches every member alike tells none of them apart, unless its text
      // is about their difference, which it is from two members on.
      const bool tells = std::any_of(set.begin(), set.end(), [&](const std::string& effect) {
        return std::find(experiment.tells.begin(), experiment.tells.end(), effect) !=
               experiment.tells.end();
      });
      if (tells) {
        out.push_back({set, std::string(experiment.action)});
        break;
      }
    }
  }
  // One line for all effects that the same experiment would show.
  for (const Experiment& experiment : experiments()) {
    NextMeasurement next{.tells_apart = {}, .action = std::string(experiment.action)};
    for (const NotTestable& effect : not_testable) {
      if (effect.because.starts_with("the table has no")) continue;
      if (std::find(experiment.tells.begin(), experiment.tells.end(), effect.effect) !=
          experiment.tells.end()) {
        next.tells_apart.push_back(effect.effect);
      }
    }
    if (!next.tells_apart.empty()) out.push_back(std::move(next));
  }
  return out;
}

}  // namespace fogbench::model
