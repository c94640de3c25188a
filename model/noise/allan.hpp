#pragma once
// Overlapping Allan deviation and the noise coefficients read from it (IEEE 952).
//   sigma^2(tau) = N^2/tau + (0.664 B)^2 + K^2 tau/3 + 3 Q^2/tau^2,  tau in hours
// Estimator: W. J. Riley, NIST Special Publication 1065 (2008), eq. 11 in terms of phase.

#include <span>
#include <vector>

#include "config/result.hpp"
#include "config/scenario.hpp"

namespace fogbench::model {

struct AllanPoint {
  double tau_s = 0.0;
  double deviation_deg_per_h = 0.0;
  /// deviation / sqrt(2 x equivalent degrees of freedom), these for white noise (SP 1065, table 5);
  /// a fit with fit_allan() needs no more.
  double standard_error_deg_per_h = 0.0;
  std::size_t count = 0;  ///< of overlapping differences
};

/// `rate_deg_per_h` at a constant interval, no gaps. tau at 2^k intervals, or every multiple when
/// `all_tau` (quadratic in the number of samples); never above a third of the record.
/// kBadInput for fewer than 3 samples, an interval that is not positive, or a sample that is not
/// a number.
Result<std::vector<AllanPoint>> allan_deviation(std::span<const double> rate_deg_per_h,
                                                double interval_s, bool all_tau = false);

struct AllanFit {
  config::NoiseCoefficients noise;
  /// NaN for a coefficient that the non-negative fit holds at zero.
  config::NoiseCoefficients standard_error;
};

/// Weighted non-negative least squares of the formula above. The weights follow the fitted curve
/// (iterated three times) and the standard errors allow for the correlation of neighbouring tau.
/// kBadInput for fewer than 4 points or a curve without a positive deviation.
Result<AllanFit> fit_allan(std::span<const AllanPoint> curve);

}  // namespace fogbench::model
