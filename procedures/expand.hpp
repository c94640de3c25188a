#pragma once
// First half of make_plan: from the procedure as written to a flat list of steps, all numbers
// bound, loops unrolled, called procedures in place. Knows nothing of the bench.

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "config/procedure.hpp"
#include "config/result.hpp"
#include "procedures/plan.hpp"

namespace fogbench::procedures {

/// Finds a called procedure by the name in the call; `caller` tells where to look first.
using ProcedureLoader = std::function<Result<config::ProcedureConfig>(
    const std::string& name, const config::ProcedureConfig& caller)>;

/// More steps than any bench could run in its life: a loop within loops gone wrong.
inline constexpr std::size_t kMaximumSteps = 100'000;

/// Steps with everything but `says` and `estimate`. Errors: kBadInput, one line with the file and
/// the JSON pointer.
Result<std::vector<PlannedStep>> expand(const config::ProcedureConfig& procedure,
                                        const Parameters& overrides, const ProcedureLoader& loader);

/// The same to its end, whatever is wrong: appends that to `problems`, and leaves out the steps
/// that it is wrong with.
std::vector<PlannedStep> expand(const config::ProcedureConfig& procedure,
                                const Parameters& overrides, const ProcedureLoader& loader,
                                std::vector<Error>& problems);

}  // namespace fogbench::procedures
