#pragma once
// The averages at each set point of the thermostat, as the thermal table of an acceptance has them.
//
//   deviation   mean of the averages at the set point - the baseline before them
//   sigma       their standard deviation about that mean; pooled over all set points of a test
//               with as many degrees of freedom as averages beyond one at each set point
//
// u(sigma) = sigma / sqrt(2 nu) (GUM, E.4.3).

#include <span>
#include <string>
#include <vector>

#include "acceptance/results.hpp"
#include "config/result.hpp"
#include "model/fit/fit.hpp"
#include "procedures/recorder.hpp"

namespace fogbench::acceptance {

struct SetPoint {
  std::string segment;
  double target_c = 0.0;
  double temperature_c = 0.0;  ///< mean of the averages
  std::size_t averages = 0;
  Figure deviation_deg_per_h;    ///< NaN without a baseline; error NaN when `fit` is null
  double sigma_deg_per_h = 0.0;  ///< NaN for a single average
};

/// `points` are the valid ones of one test in time order. `fit` of the same test says the noise.
/// Errors: as contrast_standard_error.
Result<std::vector<SetPoint>> set_points_of(std::span<const procedures::Point> points,
                                            const model::FitResult* fit);

struct PooledSigma {
  Figure sigma_deg_per_h;  ///< NaN when no set point has two averages
  double degrees_of_freedom = 0.0;
};

PooledSigma pooled_sigma(const std::vector<SetPoint>& set_points);

}  // namespace fogbench::acceptance
