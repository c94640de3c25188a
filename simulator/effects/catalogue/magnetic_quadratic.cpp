// Even in the field.

#include "simulator/effects/family.hpp"

namespace fogbench::simulator::effects {

Family magnetic_quadratic() {
  return along_each_axis("magnetic_quadratic", {}, [](std::size_t i, const Given&) {
    return [i](const TrueState& s) { return s.field_100ut[i] * s.field_100ut[i]; };
  });
}

}  // namespace fogbench::simulator::effects
