// A sensitivity to the field that follows the temperature.

#include "simulator/effects/family.hpp"

namespace fogbench::simulator::effects {

Family magnetic_temperature() {
  return along_each_axis("magnetic_temperature", {}, [](std::size_t i, const Given&) {
    return [i](const TrueState& s) { return s.field_100ut[i] * s.above_reference_c(); };
  });
}

}  // namespace fogbench::simulator::effects
