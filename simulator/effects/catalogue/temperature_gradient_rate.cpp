// A difference of temperature that changes.

#include "simulator/effects/family.hpp"

namespace fogbench::simulator::effects {

Family temperature_gradient_rate() {
  // The change since the step before; at power-on there was no difference.
  return {{.id = "temperature_gradient_rate", .make = [](const Given&) {
             return [before = 0.0](const TrueState& s) mutable {
               const double change = s.temperature_gradient_c - before;
               before = s.temperature_gradient_c;
               return change / s.step_s * 3600.0;
             };
           }}};
}

}  // namespace fogbench::simulator::effects
