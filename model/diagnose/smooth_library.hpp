#pragma once
// What an adequate model leaves flat.

#include "model/diagnose/library.hpp"

namespace fogbench::model {

/// Smooth functions of each variable that moves, in blocks. Candidate names say the variables
/// ("field_z_ut", "temperature_c x time_s").
Library make_smooth_library(const LibrarySource& source);

}  // namespace fogbench::model
