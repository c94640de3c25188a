#pragma once
// Iron has no single width: other forms of the hysteresis effects, with a density of plays
// (Prandtl-Ishlinskii). The half-widths 0 ... `width` are divided into N equal parts, and each part
// is a column with a weight of its own:
//
//   magnetic_loop_z(3)             column k = mean over the part's half-widths r of play_r(h_z)
//   magnetic_saturating_loop_z(3)  the same of hs tanh(play_r(h_z) / hs)
//   temperature_loop(3)            as the first, over t
//
// The saturating one is a Preisach model of independent coercive and interaction fields: relays of
// coercive field r whose interaction fields are spread as sech^2(h / hs) switch, taken together, as
// tanh(play_r / hs). The weights of all three are a density, and have one sign.
//
// They are no list, but made by name as sensitivities are: 1 to kMostLoopParts parts.

#include <string_view>
#include <vector>

#include "model/effects/effect.hpp"

namespace fogbench::model::effects {

inline constexpr std::size_t kMostLoopParts = 8;

/// The effect of that name; null when it is none of these. The same object every time.
const Effect* find_loop(std::string_view id);
/// The forms of "magnetic_hysteresis_z", those of fewest parts first; none for other effects.
std::vector<const Effect*> loops_of(std::string_view effect);

}  // namespace fogbench::model::effects
