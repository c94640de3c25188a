// What switching on leaves, and dies away.

#include <cmath>

#include "simulator/effects/family.hpp"

namespace fogbench::simulator::effects {

Family warm_up() {
  return {{.id = "warm_up", .parameters = {{"tau"}}, .make = [](const Given& given) {
             return
                 [tau = given.inner[0]](const TrueState& s) { return std::exp(-s.time_s / tau); };
           }}};
}

}  // namespace fogbench::simulator::effects
