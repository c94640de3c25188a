// A difference of temperature across the coil.

#include "simulator/effects/family.hpp"

namespace fogbench::simulator::effects {

Family temperature_gradient() {
  return {of_the_moment("temperature_gradient",
                        [](const TrueState& s) { return s.temperature_gradient_c; })};
}

}  // namespace fogbench::simulator::effects
