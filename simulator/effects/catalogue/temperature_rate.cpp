// The Shupe effect.

#include "simulator/effects/family.hpp"

namespace fogbench::simulator::effects {

Family temperature_rate() {
  return {of_the_moment("temperature_rate",
                        [](const TrueState& s) { return s.temperature_rate_c_per_h; })};
}

}  // namespace fogbench::simulator::effects
