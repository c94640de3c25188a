#pragma once
// Fits an error model to a table.
//
//   y_i = sum_k beta_k g_k(x_i; a) + e_i
//
// Linear coefficients beta by QR, inner parameters a by variable projection (Ceres) over the
// projected residual. Where a memory (a loop, a lag) begins is unknown: each is free
// (Effect::starts) and no part of the result. The noise e is one of: independent with one unknown
// sigma; independent with sigma proportional to a weight column; coloured (noise.hpp), estimated by
// REML with the fit.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "config/model_file.hpp"
#include "config/result.hpp"
#include "model/noise/noise.hpp"
#include "model/noise/noise_prior.hpp"
#include "model/table/table.hpp"

namespace fogbench::model {

struct FitOptions {
  enum class Noise {
    kAuto,  ///< coloured when the table has time_s and rows enough, else independent
    kIndependent,
    kColoured
  };
  Noise noise = Noise::kAuto;
  std::string weight_by;                    ///< a column of standard deviations; empty: none
  bool as_is = false;                       ///< hold every given coefficient, fit nothing
  NoisePrior prior = {};                    ///< of coloured noise
  bool doubt_rows = true;                   ///< look for single bad readings, and leave them out
  bool doubt_lag = true;                    ///< the thermometer may read late: fit_lag.hpp
  std::vector<std::size_t> leave_out = {};  ///< rows of the table that take no part
};

/// Student's t of 95.45 % coverage: 2 for many degrees of freedom, more for few, NaN for none.
double coverage_factor(double degrees_of_freedom);

/// One fitted number: a coefficient or an inner parameter.
struct Estimate {
  std::string name;  ///< "magnetic_linear_z", "earth_rate_projection.cos", "warm_up.tau"
  std::string unit;
  double value = 0.0;
  double standard_error = 0.0;   ///< NaN when not determined; 0 when held
  double coverage_factor = 2.0;  ///< expanded uncertainty = factor * standard error (95.45 %)
  bool held = false;
  bool inner = false;  ///< an inner parameter
  /// The standard error that is left when the model's inner parameters are held where they are;
  /// missing where that is not known.
  double error_at_inner = kMissing;
  std::string unexcited = {};  ///< why these data cannot show its term, which was left out
};

/// A row that was not believed (bad_rows.hpp).
struct LeftOut {
  std::size_t row = 0;  ///< of the table
  double off = 0.0;     ///< from what the other rows say of it, unit of the observable
  double sigmas = 0.0;
  std::string says;  ///< which row that is, and by how much it is off
};

struct FitResult {
  config::ModelFile fitted;  ///< with coefficients, covariance, noise: a valid input again
  std::vector<Estimate> estimates;
  Eigen::MatrixXd covariance;     ///< of the estimates that are not held, in their order
  std::vector<std::size_t> rows;  ///< which rows of the table took part (no NaN in what is needed)
  std::vector<LeftOut> left_out;  ///< single bad readings, worst first; each is a warning too
  Eigen::VectorXd predicted;      ///< one per taken row
  Eigen::VectorXd residual;       ///< observed - predicted
  Eigen::VectorXd standard_deviation;  ///< what the noise model expects of each residual
  Eigen::VectorXd whitened;            ///< residual in units of its noise, correlation removed
  NoiseEstimate noise;
  bool coloured = false;
  Windows windows;  ///< on which coloured noise was estimated, else empty
  /// Mean variance of white noise of 1 deg/sqrt(h) in a row beyond that in its window of joined
  /// rows.
  double white_beside_windows = 0.0;
  std::vector<Eigen::Index> window_of;  ///< of each taken row
  double rms = 0.0;                     ///< sqrt(mean residual^2), unit of the observable
  double residual_sum_of_squares = 0.0;
  double residual_standard_deviation = 0.0;  ///< sqrt(RSS / dof)
  double degrees_of_freedom = 0.0;
  std::vector<std::string> warnings;  ///< rank deficiency, inner parameter at its edge, ...
};

/// Errors: kBadInput: unknown effect, missing column (named), no rows, fewer rows than terms,
/// rank deficiency is a warning with the terms named.
Result<FitResult> fit(const Table& table, const config::ModelFile& model,
                      const FitOptions& options);

/// The table without the readings that were not believed. Their rows stay: histories run through
/// them.
Table without_readings(Table table, const std::string& observable,
                       const std::vector<LeftOut>& left_out);

}  // namespace fogbench::model
