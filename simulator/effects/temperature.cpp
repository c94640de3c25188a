// Effects of the carrier's temperature, its derivatives and its history.

#include <cmath>
#include <numbers>

#include "simulator/effects/effect.hpp"
#include "simulator/effects/memory.hpp"

namespace fogbench::simulator {

void add_temperature_effects(std::vector<EffectEntry>& entries) {
  const auto add = [&](const char* id, double (*value)(const TrueState&)) {
    entries.push_back({id, {}, [value](auto) { return Regressor(value); }});
  };
  add("temperature_linear", [](const TrueState& s) { return s.above_reference_c(); });
  add("temperature_quadratic",
      [](const TrueState& s) { return std::pow(s.above_reference_c(), 2); });
  add("temperature_cubic", [](const TrueState& s) { return std::pow(s.above_reference_c(), 3); });
  add("temperature_rate", [](const TrueState& s) { return s.temperature_rate_c_per_h; });
  add("temperature_acceleration",
      [](const TrueState& s) { return s.temperature_acceleration_c_per_h2; });
  add("temperature_rate_cross",
      [](const TrueState& s) { return s.above_reference_c() * s.temperature_rate_c_per_h; });
  add("temperature_gradient", [](const TrueState& s) { return s.temperature_gradient_c; });

  // The change since the step before; at power-on there was no difference.
  entries.push_back({"temperature_gradient_rate", {}, [](auto) {
                       return [before = 0.0](const TrueState& s) mutable {
                         const double change = s.temperature_gradient_c - before;
                         before = s.temperature_gradient_c;
                         return change / s.step_s * 3600.0;
                       };
                     }});
  entries.push_back({"temperature_rate_lagged", {{"tau"}}, [](auto inner) {
                       return [lag = Lag(inner[0], 0.0)](const TrueState& s) mutable {
                         return lag.follow(s.temperature_rate_c_per_h, s.step_s);
                       };
                     }});
  entries.push_back(
      {"temperature_hysteresis", {{"width", ParameterDomain::kNotNegative}}, [](auto inner) {
         return [play = Play(inner[0])](const TrueState& s) mutable {
           return play.follow(s.above_reference_c());
         };
       }});
  entries.push_back({"temperature_ripple",
                     {{"period"}, {"phase_deg", ParameterDomain::kAny, false}},
                     [](auto inner) {
                       return [period_c = inner[0], phase_deg = inner[1]](const TrueState& s) {
                         const double turns = s.temperature_c / period_c - phase_deg / 360.0;
                         return std::cos(2.0 * std::numbers::pi * turns);
                       };
                     }});
}

}  // namespace fogbench::simulator
