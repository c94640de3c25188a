// Effects of what surrounds the gyro: heaters, room, coils, orientation.

#include <cmath>
#include <numbers>

#include "simulator/effects/effect.hpp"
#include "simulator/effects/memory.hpp"

namespace fogbench::simulator {

void add_bench_effects(std::vector<EffectEntry>& entries) {
  entries.push_back(
      {"heater_power", {}, [](auto) { return [](const TrueState& s) { return s.heater_w; }; }});
  entries.push_back({"ambient_temperature", {}, [](auto) {
                       return [](const TrueState& s) {
                         return s.ambient_c - s.reference_temperature_c;
                       };
                     }});
  entries.push_back({"coil_heating", {{"tau"}}, [](auto inner) {
                       return [lag = Lag(inner[0], 0.0)](const TrueState& s) mutable {
                         return lag.follow(s.sum_squared_current_a2, s.step_s);
                       };
                     }});
  entries.push_back(
      {"earth_rate_projection", {{"phase_deg", ParameterDomain::kAny, false}}, [](auto inner) {
         return [phase_deg = inner[0]](const TrueState& s) {
           return std::cos((s.azimuth_deg - phase_deg) * std::numbers::pi / 180.0);
         };
       }});
}

}  // namespace fogbench::simulator
