// A Shupe effect behind a heat resistance.

#include "simulator/effects/family.hpp"
#include "simulator/effects/memory.hpp"

namespace fogbench::simulator::effects {

Family temperature_rate_lagged() {
  return {
      {.id = "temperature_rate_lagged", .parameters = {{"tau"}}, .make = [](const Given& given) {
         return [lag = Lag(given.inner[0], 0.0)](const TrueState& s) mutable {
           return lag.follow(s.temperature_rate_c_per_h, s.step_s);
         };
       }}};
}

}  // namespace fogbench::simulator::effects
