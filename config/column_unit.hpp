#pragma once
// The unit that a column's name states: "gyro [deg/s]", "omega_rad_s", "T (K)", "B_nT".

#include <string_view>

#include "config/result.hpp"
#include "config/stated_unit.hpp"

namespace fogbench::config {

/// Null where the name states none. Errors: kBadInput for brackets around what is no unit; a name
/// that merely ends in letters states none.
Result<const StatedUnit*> unit_in_name(std::string_view name);

}  // namespace fogbench::config
