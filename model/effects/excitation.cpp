#include "model/effects/excitation.hpp"

#include <fmt/format.h>

#include "model/table/moving_signals.hpp"

namespace fogbench::model {

std::string unexcited_because(const EffectInfo& info, const Signals& signals) {
  for (const std::string& name : info.signals) {
    if (name == "time_s" || name == "duration_s") continue;
    if (!moving_signal(signals, name, least_excitation(name))) {
      return fmt::format("{} stays at one value", name);
    }
  }
  return info.hidden_because ? info.hidden_because(signals) : std::string();
}

}  // namespace fogbench::model
