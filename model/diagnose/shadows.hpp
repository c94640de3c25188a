#pragma once
// The shapes that no effect of the catalogue has: without them what is outside it gets the name of
// the effect that resembles it most.

#include "model/diagnose/library_builder.hpp"

namespace fogbench::model {

void add_shadows(LibraryBuilder& builder);

}  // namespace fogbench::model
