// Effects of time alone.

#include <cmath>

#include "simulator/effects/effect.hpp"

namespace fogbench::simulator {

void add_drift_effects(std::vector<EffectEntry>& entries) {
  entries.push_back({"bias", {}, [](auto) { return [](const TrueState&) { return 1.0; }; }});
  entries.push_back({"bias_step", {{"t0", ParameterDomain::kAny}}, [](auto inner) {
                       return [t0 = inner[0]](const TrueState& s) {
                         return s.time_s >= t0 ? 1.0 : 0.0;
                       };
                     }});
  entries.push_back({"drift_linear", {}, [](auto) {
                       return [](const TrueState& s) { return s.time_s / 3600.0; };
                     }});
  entries.push_back({"warm_up", {{"tau"}}, [](auto inner) {
                       return [tau = inner[0]](const TrueState& s) {
                         return std::exp(-s.time_s / tau);
                       };
                     }});
}

}  // namespace fogbench::simulator
