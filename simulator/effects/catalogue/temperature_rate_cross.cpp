// A Shupe effect that grows with the temperature.

#include "simulator/effects/family.hpp"

namespace fogbench::simulator::effects {

Family temperature_rate_cross() {
  return {of_the_moment("temperature_rate_cross", [](const TrueState& s) {
    return s.above_reference_c() * s.temperature_rate_c_per_h;
  })};
}

}  // namespace fogbench::simulator::effects
