#pragma once
// The catalogue of physical effects. One effect, or one family of the three axes, is one file in
// model/effects/catalogue/, with all that anybody asks of it; the build makes the list of these
// files. Nobody else knows an effect by its name.

#include <span>
#include <string>
#include <string_view>

#include "model/effects/effect.hpp"

namespace fogbench::model {

/// All effects, in the order of the documentation.
std::span<const Effect* const> catalogue();
/// Null when there is no such effect.
const Effect* find_effect(std::string_view id);
/// "unknown effect 'x'", and which of the catalogue was probably meant: one, or a family.
std::string unknown_effect(std::string_view id);
/// The effect scales with the shield (EffectInfo::field_sensitivity); false for other names.
bool is_field_sensitivity(std::string_view id);

}  // namespace fogbench::model
