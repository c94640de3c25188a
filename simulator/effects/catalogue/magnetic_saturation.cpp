// A shield that saturates.

#include <cmath>

#include "simulator/effects/family.hpp"

namespace fogbench::simulator::effects {

Family magnetic_saturation() {
  return along_each_axis("magnetic_saturation", {{"hs"}}, [](std::size_t i, const Given& given) {
    return
        [i, hs = given.inner[0]](const TrueState& s) { return std::tanh(s.field_100ut[i] / hs); };
  });
}

}  // namespace fogbench::simulator::effects
