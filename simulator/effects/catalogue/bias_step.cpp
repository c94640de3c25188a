// Something jumps, once.

#include "simulator/effects/family.hpp"

namespace fogbench::simulator::effects {

Family bias_step() {
  return {{.id = "bias_step",
           .parameters = {{"t0", ParameterDomain::kAny}},
           .make = [](const Given& given) {
             return
                 [t0 = given.inner[0]](const TrueState& s) { return s.time_s >= t0 ? 1.0 : 0.0; };
           }}};
}

}  // namespace fogbench::simulator::effects
