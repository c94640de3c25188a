#pragma once
// Noise of window averages in IEEE 952 terms, as a covariance and as the whitening that undoes it.
//
//   y = X beta + e,  cov(e) = Omega,  blocks independent between runs
//   Omega = white: N^2/tau on the diagonal (tau in hours), times what the row's stated error says
//         + flicker: Ornstein-Uhlenbeck terms log-spaced by a ratio r, variances B^2 ln(r)/pi each
//         + rate random walk: K times a Wiener process that is zero where the run starts
//
// Windows are averages, not points: every covariance is the double integral over both windows.
// A walk that starts at zero and flicker that lasts longer than the run look like a bias; a model
// with a bias term takes it out. Quantisation is left out of Omega: it falls with 1/tau^2 and is
// far below the white noise in windows of a second and more.

#include <Eigen/Core>
#include <memory>
#include <utility>
#include <vector>

#include "config/result.hpp"
#include "config/scenario.hpp"

namespace fogbench::model {

using config::NoiseCoefficients;

/// Where the averaging windows lie. All vectors have one entry a row; rows of a run are contiguous
/// and in time order. Windows may have gaps and unequal lengths, but never overlap in a run.
struct Windows {
  std::vector<std::size_t> run_begin;  ///< first row of each run, then the number of rows
  Eigen::VectorXd centre_s;
  Eigen::VectorXd duration_s;
  Eigen::VectorXd white_floor;  ///< stated standard error of each row, 0 when unknown, deg/h
  /// White variance of each row over N^2/tau (stated_errors.hpp); empty: 1 in all of them.
  Eigen::VectorXd white_scale = {};

  Eigen::Index rows() const { return centre_s.size(); }
};

/// Rows without usable times are taken to follow each other in windows of this length, as a bench's
/// averages do, so that what instruments do in an hour (noise_prior.hpp) means something.
inline constexpr double kUntimedWindow_s = 180.0;

/// kBadInput when windows overlap, run backwards, have no duration, or no number.
Status check_windows(const Windows& windows);

/// The factor L of Omega = L L', applied without ever forming it.
class Whitener {
 public:
  virtual ~Whitener() = default;
  /// L^-1 times any number of columns; as many rows as the windows have.
  virtual Eigen::MatrixXd whiten(const Eigen::MatrixXd& columns) const = 0;
  /// L times the columns: turns independent unit normals into a draw of the noise.
  virtual Eigen::MatrixXd colour(const Eigen::MatrixXd& columns) const = 0;
  /// L' times the columns: |L'w|^2 is the variance of the weighted sum w'e.
  virtual Eigen::MatrixXd colour_transposed(const Eigen::MatrixXd& columns) const = 0;
  virtual double log_determinant() const = 0;  ///< of Omega
  /// Total standard deviation of each row, sqrt(diag Omega).
  virtual Eigen::VectorXd standard_deviation() const = 0;
};

/// Exact for any number of rows: the noise is a small linear system (one state for each
/// Ornstein-Uhlenbeck term, one for the walk), so a Kalman filter over the windows gives the
/// innovations L^-1 y in O(rows J^2).
/// kBadInput as check_windows, or when a coefficient is negative or all of them are zero.
Result<std::unique_ptr<Whitener>> make_whitener(const Windows& windows,
                                                const NoiseCoefficients& noise);

/// Independent rows of the given standard deviations (all positive).
std::unique_ptr<Whitener> make_independent_whitener(Eigen::VectorXd standard_deviation);

/// Omega in full, rows x rows: for a few thousand rows at most, and for tests.
Result<Eigen::MatrixXd> noise_covariance(const Windows& windows, const NoiseCoefficients& noise);

/// The noise that maximises the restricted likelihood of y given the columns of X, with the spread
/// of the estimates over shapes (B and K relative to N).
struct NoiseEstimate {
  NoiseCoefficients noise;
  double log_likelihood = 0.0;  ///< restricted
  /// Noise models that the data do not exclude, with weights that sum to 1: what a covariance of
  /// beta has to be averaged over.
  std::vector<std::pair<NoiseCoefficients, double>> plausible;
  bool anchored = false;  ///< N was bounded below by the stated standard errors
  std::string says;       ///< "white 0.001 deg/sqrt(h), flicker not distinguishable from zero..."
};

/// The noise part of gls() (model/fit/gls.hpp), which is the one to call when beta is wanted too.
/// Errors: as check_windows; kBadInput when there are not more rows than columns.
Result<NoiseEstimate> estimate_noise(const Windows& windows, const Eigen::MatrixXd& x,
                                     const Eigen::VectorXd& y);

}  // namespace fogbench::model
