// Ageing within a run.

#include "simulator/effects/family.hpp"

namespace fogbench::simulator::effects {

Family drift_linear() {
  return {of_the_moment("drift_linear", [](const TrueState& s) { return s.time_s / 3600.0; })};
}

}  // namespace fogbench::simulator::effects
