#pragma once
// What the study of the diagnosis asks, part by part.

#include <string>
#include <vector>

#include "tests/support/diagnosis_trial.hpp"

namespace fogbench::tests {

/// nulls, effects, pairs, outside, shapes, sizes, columns. Effects that a design does not excite
/// are not asked of it.
std::vector<DiagnosisCase> study_cases();

}  // namespace fogbench::tests
