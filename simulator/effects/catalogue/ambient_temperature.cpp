// What the room adds, past the thermostat.

#include "simulator/effects/family.hpp"

namespace fogbench::simulator::effects {

Family ambient_temperature() {
  return {of_the_moment("ambient_temperature", [](const TrueState& s) {
    return s.ambient_c - s.reference_temperature_c;
  })};
}

}  // namespace fogbench::simulator::effects
