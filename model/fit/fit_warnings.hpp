#pragma once
// Where a fit's numbers say less than they seem to.

#include <string>
#include <vector>

#include "model/fit/fit.hpp"

namespace fogbench::model {

/// Of estimates that are nearly inseparable, of an exact fit, and of coefficients that the data do
/// not determine. Needs estimates, covariance, predicted and residual.
std::vector<std::string> weak_evidence(const FitResult& result);

}  // namespace fogbench::model
