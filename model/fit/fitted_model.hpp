#pragma once
// The model file with a fit's results in it: a valid input again.

#include "config/model_file.hpp"
#include "model/fit/design.hpp"
#include "model/fit/fit.hpp"

namespace fogbench::model {

/// `model` with coefficients, inner parameters, their covariance and the noise of `result`. Terms
/// that were left out whole are not in it. `design`: of the fit; `result.estimates` holds its own
/// columns, then its parameters.
config::ModelFile fitted_model(const config::ModelFile& model, const Design& design,
                               const FitResult& result);

}  // namespace fogbench::model
