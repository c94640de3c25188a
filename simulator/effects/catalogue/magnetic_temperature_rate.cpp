// A sensitivity to the field that follows the temperature's change.

#include "simulator/effects/family.hpp"

namespace fogbench::simulator::effects {

Family magnetic_temperature_rate() {
  return along_each_axis("magnetic_temperature_rate", {}, [](std::size_t i, const Given&) {
    return [i](const TrueState& s) { return s.field_100ut[i] * s.temperature_rate_c_per_h; };
  });
}

}  // namespace fogbench::simulator::effects
