#pragma once
// Noise of window averages in IEEE 952 terms, and the likelihood that goes with it.
//
//   y = X beta + e,  cov(e) = Omega,  blocks independent between runs
//   Omega = white N^2/tau (diagonal, tau in hours; bounded below by the stated standard error)
//         + flicker: Ornstein-Uhlenbeck terms log-spaced by a ratio r, variances B^2 ln(r)/pi each
//         + rate random walk: covariance of the window means of K times a Wiener process
//
// Windows are averages, not points: every covariance is the double integral over both windows.
// Dense Cholesky up to about 2,000 rows; above it a state-space (Kalman) whitening, O(rows J^2).

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "config/result.hpp"
#include "config/scenario.hpp"

namespace fogbench::model {

using config::NoiseCoefficients;

/// Where the averaging windows lie. All vectors have one entry a row; rows of a run are contiguous
/// and in time order.
struct Windows {
  std::vector<std::size_t> run_begin;  ///< first row of each run, then the number of rows
  Eigen::VectorXd centre_s;
  Eigen::VectorXd duration_s;
  Eigen::VectorXd white_floor;  ///< stated standard error of each row, 0 when unknown, deg/h
};

/// Multiplies by L^-1 where Omega = L L'.
class Whitener {
 public:
  virtual ~Whitener() = default;
  /// Any number of columns; as many rows as the windows have.
  virtual Eigen::MatrixXd whiten(const Eigen::MatrixXd& columns) const = 0;
  virtual double log_determinant() const = 0;  ///< of Omega
  /// Total standard deviation of each row, sqrt(diag Omega).
  virtual Eigen::VectorXd standard_deviation() const = 0;
};

/// kBadInput when windows overlap, run backwards or have no duration.
Result<std::unique_ptr<Whitener>> make_whitener(const Windows& windows,
                                                const NoiseCoefficients& noise);

/// The noise that maximises the restricted likelihood of y given the columns of X, with the spread
/// of the estimates over shapes (B and K relative to N).
struct NoiseEstimate {
  NoiseCoefficients noise;
  double log_likelihood = 0.0;  ///< restricted
  /// Noise models that the data do not exclude, with weights that sum to 1: what a covariance of
  /// beta has to be averaged over.
  std::vector<std::pair<NoiseCoefficients, double>> plausible;
  std::string says;  ///< "white, flicker not distinguishable from zero..."
};

/// Errors: kBadInput when there are not more rows than columns.
Result<NoiseEstimate> estimate_noise(const Windows& windows, const Eigen::MatrixXd& x,
                                     const Eigen::VectorXd& y);

}  // namespace fogbench::model
