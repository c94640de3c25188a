// The field coils warm what they surround.

#include "simulator/effects/family.hpp"
#include "simulator/effects/memory.hpp"

namespace fogbench::simulator::effects {

Family coil_heating() {
  return {{.id = "coil_heating", .parameters = {{"tau"}}, .make = [](const Given& given) {
             return [lag = Lag(given.inner[0], 0.0)](const TrueState& s) mutable {
               return lag.follow(s.sum_squared_current_a2, s.step_s);
             };
           }}};
}

}  // namespace fogbench::simulator::effects
