// Two axes of the field at once.

#include "simulator/effects/family.hpp"

namespace fogbench::simulator::effects {

Family magnetic_cross() {
  Family all;
  for (std::size_t i = 0; i < kAxes.size(); ++i) {
    const std::size_t j = (i + 1) % kAxes.size();
    all.push_back({.id = std::string("magnetic_cross_") + kAxes[i] + kAxes[j],
                   .make =
                       [i, j](const Given&) {
                         return [i, j](const TrueState& s) {
                           return s.field_100ut[i] * s.field_100ut[j];
                         };
                       },
                   .through_shield = true});
  }
  return all;
}

}  // namespace fogbench::simulator::effects
