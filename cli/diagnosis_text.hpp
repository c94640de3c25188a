#pragma once

#include <string_view>

#include "model/diagnose/diagnose.hpp"

namespace fogbench::cli {

/// A diagnosis as text on stdout: the verdict in sentences, where the model fails most, the error
/// as effects are added, what was not found and what to measure next. `unit`: of the observable.
void print_diagnosis(const model::Diagnosis& d, std::string_view unit);

}  // namespace fogbench::cli
