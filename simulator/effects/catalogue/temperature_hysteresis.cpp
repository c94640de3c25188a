// Glue and fibre that give way late.

#include "simulator/effects/family.hpp"
#include "simulator/effects/memory.hpp"

namespace fogbench::simulator::effects {

Family temperature_hysteresis() {
  return {{.id = "temperature_hysteresis",
           .parameters = {{"width", ParameterDomain::kNotNegative}},
           .make = [](const Given& given) {
             return [play = Play(given.inner[0])](const TrueState& s) mutable {
               return play.follow(s.above_reference_c());
             };
           }}};
}

}  // namespace fogbench::simulator::effects
