// Eddy currents: every step of the field dies away by itself.

#include <optional>

#include "simulator/effects/family.hpp"
#include "simulator/effects/memory.hpp"

namespace fogbench::simulator::effects {

Family magnetic_settling() {
  return along_each_axis("magnetic_settling", {{"tau"}}, [](std::size_t i, const Given& given) {
    // The field less its lagged self.
    return [i, tau = given.inner[0], lag = std::optional<Lag>()](const TrueState& s) mutable {
      const double h = s.field_100ut[i];
      if (!lag) lag.emplace(tau, h);  // The field at power-on had been there long before.
      return h - lag->follow(h, s.step_s);
    };
  });
}

}  // namespace fogbench::simulator::effects
