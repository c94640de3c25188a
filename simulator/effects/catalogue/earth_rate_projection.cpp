// The axis is not quite vertical: it sees some of the horizontal rate.

#include <cmath>
#include <numbers>

#include "simulator/effects/family.hpp"

namespace fogbench::simulator::effects {

Family earth_rate_projection() {
  return {{.id = "earth_rate_projection",
           .parameters = {{"phase_deg", ParameterDomain::kAny, false}},
           .make = [](const Given& given) {
             return [phase_deg = given.inner[0]](const TrueState& s) {
               return std::cos((s.azimuth_deg - phase_deg) * std::numbers::pi / 180.0);
             };
           }}};
}

}  // namespace fogbench::simulator::effects
