// The Faraday effect.

#include "simulator/effects/family.hpp"

namespace fogbench::simulator::effects {

Family magnetic_linear() {
  return along_each_axis("magnetic_linear", {}, [](std::size_t i, const Given&) {
    return [i](const TrueState& s) { return s.field_100ut[i]; };
  });
}

}  // namespace fogbench::simulator::effects
