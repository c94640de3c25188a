#pragma once
// The unit that a column's name states: "gyro [deg/s]", "omega_rad_s", "T (K)", "B_nT".

#include <string_view>

#include "config/result.hpp"
#include "config/stated_unit.hpp"

namespace fogbench::config {

/// The unit that a person or another program wrote so: "°/s", "deg/hr", "мкТл"; null for none. A
/// device file spells it as find_unit does.
const StatedUnit* unit_spelt(std::string_view text);

/// The name without its unit and without what joins them: "gyro" of "gyro [deg/s]" and of
/// "gyro_deg_s".
std::string_view name_without_unit(std::string_view name);

/// Null where the name states none. Errors: kBadInput for brackets around what is no unit; a name
/// that merely ends in letters states none.
Result<const StatedUnit*> unit_in_name(std::string_view name);

}  // namespace fogbench::config
