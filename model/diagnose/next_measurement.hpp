#pragma once

#include <string>
#include <vector>

#include "model/diagnose/diagnose.hpp"

namespace fogbench::model {

/// What to measure on the bench so that the effects of each ambiguous set come apart, and so that
/// effects that these data cannot show at all would show.
std::vector<NextMeasurement> next_measurements(
    const std::vector<std::vector<std::string>>& ambiguous,
    const std::vector<NotTestable>& not_testable);

}  // namespace fogbench::model
