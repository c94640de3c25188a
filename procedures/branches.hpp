#pragma once
// A sweep's levels as branches of a loop.

#include <string>
#include <vector>

namespace fogbench::procedures {

/// The branch of each level of a sweep. A branch is a run of levels in one direction; the extreme
/// belongs to the branch that reached it. One that comes back to 0 from one side, and is not the
/// first, is "return"; others are "up" or "down". A name that comes again is numbered ("up2"): it
/// starts from another field history.
std::vector<std::string> branch_names(const std::vector<double>& levels);

}  // namespace fogbench::procedures
