#include "simulator/effects/effect.hpp"

namespace fogbench::simulator {

const std::vector<EffectEntry>& all_effects() {
  static const std::vector<EffectEntry> entries = [] {
    std::vector<EffectEntry> all;
    add_drift_effects(all);
    add_temperature_effects(all);
    add_magnetic_effects(all);
    add_bench_effects(all);
    return all;
  }();
  return entries;
}

}  // namespace fogbench::simulator
