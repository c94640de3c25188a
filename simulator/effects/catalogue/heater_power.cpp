// What the heaters add by themselves.

#include "simulator/effects/family.hpp"

namespace fogbench::simulator::effects {

Family heater_power() {
  return {of_the_moment("heater_power", [](const TrueState& s) { return s.heater_w; })};
}

}  // namespace fogbench::simulator::effects
