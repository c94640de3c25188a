// A shield that remembers.

#include "simulator/effects/family.hpp"
#include "simulator/effects/memory.hpp"

namespace fogbench::simulator::effects {

Family magnetic_hysteresis() {
  return along_each_axis("magnetic_hysteresis", {{"width", ParameterDomain::kNotNegative}},
                         [](std::size_t i, const Given& given) {
                           return [i, play = Play(given.inner[0])](const TrueState& s) mutable {
                             return play.follow(s.field_100ut[i]);
                           };
                         });
}

}  // namespace fogbench::simulator::effects
