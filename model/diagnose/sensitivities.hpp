#pragma once
// Every further column of numbers as a cause, in the generic forms of
// model/effects/sensitivity.hpp.

#include "model/diagnose/library_builder.hpp"

namespace fogbench::model {

/// Effects of the columns that are not of the measurement table: causes that somebody recorded.
void add_sensitivities(LibraryBuilder& builder);

}  // namespace fogbench::model
