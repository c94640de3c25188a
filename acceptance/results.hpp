#pragma once
// The results of a run as the acceptance procedure reports them, from its points alone.
//
//   deviation   mean of a point - mean of the last baseline before it in the same test
//   K           [omega(highest level) - omega(lowest)] / (their distance / 100 uT),
//               commanded levels
//   slope       ordinary least squares, per 100 uT,
//               against the measured field of the swept axis
//   closure     z0 - 2 z12 + z24 over the three zero-field readings of a sweep 0, +, 0, -, 0:
//               0 for a drift that is linear in time, -3r for a remanence of +-r
//
// Standard errors are those of white noise within the windows, so lower bounds; the fitted model
// states honest ones.

#include <span>
#include <string>
#include <vector>

#include "procedures/recorder.hpp"

namespace fogbench::acceptance {

/// A number and its standard error; both NaN when the run has no points for it.
struct Figure {
  double value;
  double standard_error;
};

struct Deviation {
  int test = 1;
  std::string segment;
  double time_s = 0.0;
  double target_c = 0.0;  ///< NaN without heating
  double temperature_c = 0.0;
  double field_set_ut = 0.0;  ///< NaN outside a sweep
  double field_ut = 0.0;      ///< measured, along the swept axis; NaN outside a sweep
  double rate_deg_per_h = 0.0;
  Figure deviation_deg_per_h;  ///< NaN without a baseline
};

struct SweepResult {
  int test = 1;
  std::string sweep;  ///< segment before the '/'
  char axis = '?';    ///< x, y or z: the one that the measured field moved along
  std::size_t points = 0;
  procedures::Point lowest, highest;  ///< by commanded level: what K is made of
  Figure k_deg_per_h;                 ///< per 100 uT
  Figure slope_deg_per_h;             ///< per 100 uT
  Figure intercept_deg_per_h;         ///< at zero measured field, as deviation from the baseline
  double zero_first_deg_per_h, zero_middle_deg_per_h, zero_last_deg_per_h;  ///< deviations
  Figure drift_deg_per_h;  ///< last zero - first zero
  Figure closure_deg_per_h;
};

struct RunResults {
  std::vector<Deviation> temperature;  ///< averages outside sweeps
  std::vector<Deviation> magnetic;     ///< levels of sweeps
  std::vector<SweepResult> sweeps;
};

/// `points` are the valid ones in time order.
RunResults derive_results(std::span<const procedures::Point> points);

}  // namespace fogbench::acceptance
