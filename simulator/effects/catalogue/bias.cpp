// The rate of a gyro that stands still.

#include "simulator/effects/family.hpp"

namespace fogbench::simulator::effects {

Family bias() {
  return {of_the_moment("bias", [](const TrueState&) { return 1.0; })};
}

}  // namespace fogbench::simulator::effects
