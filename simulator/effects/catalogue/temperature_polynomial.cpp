// Powers of the carrier's temperature above the reference.

#include <cmath>

#include "simulator/effects/family.hpp"

namespace fogbench::simulator::effects {

Family temperature_polynomial() {
  return {
      of_the_moment("temperature_linear", [](const TrueState& s) { return s.above_reference_c(); }),
      of_the_moment("temperature_quadratic",
                    [](const TrueState& s) { return std::pow(s.above_reference_c(), 2); }),
      of_the_moment("temperature_cubic",
                    [](const TrueState& s) { return std::pow(s.above_reference_c(), 3); }),
  };
}

}  // namespace fogbench::simulator::effects
