#pragma once
// Overlapping Allan deviation and the noise coefficients read from it (IEEE 952).
//   sigma^2(tau) = N^2/tau + (0.664 B)^2 + K^2 tau/3 + 3 Q^2/tau^2

#include <span>
#include <vector>

#include "config/result.hpp"
#include "config/scenario.hpp"

namespace fogbench::model {

struct AllanPoint {
  double tau_s = 0.0;
  double deviation_deg_per_h = 0.0;
  double standard_error_deg_per_h = 0.0;
  std::size_t count = 0;
};

/// `rate_deg_per_h` at a constant interval, no gaps. tau at 2^k intervals, or every m when
/// `all_tau`. kBadInput for fewer than 3 samples.
Result<std::vector<AllanPoint>> allan_deviation(std::span<const double> rate_deg_per_h,
                                                double interval_s, bool all_tau = false);

struct AllanFit {
  config::NoiseCoefficients noise;
  config::NoiseCoefficients standard_error;
};
/// Weighted non-negative least squares of the formula above.
Result<AllanFit> fit_allan(std::span<const AllanPoint> curve);

}  // namespace fogbench::model
