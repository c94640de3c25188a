// A memory of the temperature: after a reversal nothing happens until it has moved by twice the
// width.

#include <algorithm>
#include <limits>

#include "model/effects/function_effect.hpp"
#include "model/effects/history.hpp"
#include "model/table/moving_signals.hpp"

namespace fogbench::model::effects {
namespace {

/// A loop needs a branch of this part of the range.
constexpr double kCoolingBranch = 0.25;

/// Largest fall from an earlier maximum, within a run.
double deepest_fall(const Signals& signals, const Eigen::VectorXd& value) {
  double fall = 0.0;
  for (const Signals::RunRange& run : signals.runs()) {
    double top = -std::numeric_limits<double>::infinity();
    for (std::size_t i = run.begin; i < run.end; ++i) {
      const double v = value[static_cast<Eigen::Index>(i)];
      top = std::max(top, v);
      fall = std::max(fall, top - v);
    }
  }
  return fall;
}

std::string never_cooled(const Signals& signals) {
  const auto t = moving_signal(signals, "temperature_c");
  if (t && deepest_fall(signals, t->value) >= kCoolingBranch * t->span()) return {};
  return "temperature_c is never lowered: a cooling branch is needed";
}

}  // namespace

Family temperature_hysteresis() {
  return {{
      .info = {.id = "temperature_hysteresis",
               .group = EffectInfo::Group::kTemperature,
               .formula = "play_width(t)",
               .columns = {""},
               .units = {"deg/h/degC"},
               .signals = {"temperature_c"},
               .parameters = {{.name = "width", .unit = "degC", .minimum = 0.5, .maximum = 10.0}},
               .excited_by = "heating and cooling branches",
               .confused_with = "drift_linear, without a cooling branch",
               .source =
                   "M. Brokate, J. Sprekels, Hysteresis and Phase Transitions (Springer 1996)",
               .has_history = true,
               .limit = "temperature_linear",
               .hidden_because = never_cooled,
               .in_challenge = InChallenge{InChallenge::By::kHeating, 10, {{"width", {3.0, 8.0}}}}},
      .regressor = [](const Signals& signals, std::span<const double> inner) -> Eigen::MatrixXd {
        return play(signals, excess_temperature(signals), inner[0]);
      },
      .starts = [](const Signals& signals, std::span<const double> inner) -> Eigen::MatrixXd {
        return play_starts(signals, excess_temperature(signals), inner[0]);
      },
      .other_shapes = [](const Effect&, const Signals& signals) -> std::vector<Shape> {
        return {[&signals](double width) -> Eigen::MatrixXd {
          return relaxing_loop(signals, signals.signal("temperature_c"), width);
        }};
      },
  }};
}

}  // namespace fogbench::model::effects
