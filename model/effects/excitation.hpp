#pragma once
// Which effects the data cannot show.

#include <string>

#include "model/effects/effect.hpp"

namespace fogbench::model {

/// Why the effect cannot show in these data although its signals are there; empty when it can.
std::string unexcited_because(const EffectInfo& info, const Signals& signals);

}  // namespace fogbench::model
