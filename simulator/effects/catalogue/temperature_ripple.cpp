// Interference that passes through its fringes.

#include <cmath>
#include <numbers>

#include "simulator/effects/family.hpp"

namespace fogbench::simulator::effects {

Family temperature_ripple() {
  return {{.id = "temperature_ripple",
           .parameters = {{"period"}, {"phase_deg", ParameterDomain::kAny, false}},
           .make = [](const Given& given) {
             return [period_c = given.inner[0], phase_deg = given.inner[1]](const TrueState& s) {
               const double turns = s.temperature_c / period_c - phase_deg / 360.0;
               return std::cos(2.0 * std::numbers::pi * turns);
             };
           }}};
}

}  // namespace fogbench::simulator::effects
