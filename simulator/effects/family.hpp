#pragma once
// What the files of simulator/effects/catalogue/ are written with.

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "simulator/effects/effect.hpp"

namespace fogbench::simulator::effects {

using Family = std::vector<EffectEntry>;

inline constexpr std::string_view kAxes = "xyz";

/// One without memory and inner parameters.
inline EffectEntry of_the_moment(std::string id, double (*value)(const TrueState&)) {
  return {.id = std::move(id), .make = [value](const Given&) { return Regressor(value); }};
}

/// One for each axis of the field: `make` gets the axis and what is given.
template <class Make>
Family along_each_axis(const std::string& family, const std::vector<EffectParameter>& parameters,
                       Make make) {
  Family all;
  for (std::size_t i = 0; i < kAxes.size(); ++i) {
    all.push_back({.id = family + "_" + kAxes[i],
                   .parameters = parameters,
                   .make = [make, i](const Given& given) -> Regressor { return make(i, given); },
                   .through_shield = true});
  }
  return all;
}

}  // namespace fogbench::simulator::effects
