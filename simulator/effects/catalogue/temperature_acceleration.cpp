// The edges of temperature steps.

#include "simulator/effects/family.hpp"

namespace fogbench::simulator::effects {

Family temperature_acceleration() {
  return {of_the_moment("temperature_acceleration",
                        [](const TrueState& s) { return s.temperature_acceleration_c_per_h2; })};
}

}  // namespace fogbench::simulator::effects
