#pragma once

#include <string_view>

#include "model/diagnose/diagnose.hpp"
#include "model/diagnose/verdict_text.hpp"

namespace fogbench::cli {

/// A diagnosis as text on stdout: a line each of verdict, evidence and what to do; then the error
/// as effects are added, the details, where the model fails most, what else tells the effects
/// apart, what was not found, and what would show what these data cannot. `unit`: of the
/// observable.
void print_diagnosis(const model::Diagnosis& d, const model::VerdictWords& words,
                     std::string_view unit);

}  // namespace fogbench::cli
