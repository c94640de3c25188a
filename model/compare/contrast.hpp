#pragma once
// The standard error of a weighted sum of averages under the noise that a fit found: of a
// difference of two means, of K from the two extremes of a sweep. Scatter within the windows alone
// would leave out what drifts between them.
//
//   u^2 = w' Omega w, averaged over the noise shapes that the data do not exclude (noise.hpp)

#include <vector>

#include "config/result.hpp"
#include "model/fit/fit.hpp"

namespace fogbench::model {

/// One average and its weight in the sum.
struct WeightedWindow {
  double weight = 0.0;
  double centre_s = 0.0, duration_s = 0.0;
  double rate_std_error_deg_per_h = 0.0;
};

/// The windows are of one run and do not overlap; any order. With independent noise each counts the
/// fit's residual deviation. kBadInput when they overlap.
Result<double> contrast_standard_error(std::vector<WeightedWindow> windows, const FitResult& fit);

}  // namespace fogbench::model
