// The rate follows a quantity that an auxiliary sensor of the bench measures, less its mean: the
// room's pressure, a supply voltage. The amplitude is in deg/h per unit of the channel.

#include "simulator/effects/family.hpp"

namespace fogbench::simulator::effects {

Family sensitivity() {
  return {{.id = "sensitivity",
           .make =
               [](const Given& given) {
                 return
                     [channel = given.channel](const TrueState& s) { return s.measured(channel); };
               },
           .of_a_channel = true}};
}

}  // namespace fogbench::simulator::effects
