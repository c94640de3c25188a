#pragma once
// Generalised least squares under noise that is itself estimated from the residual.
//
//   restricted likelihood of a shape s = (B/N, K/N), Omega = N^2 R_s, nu = rows - rank X:
//   log l = -(log|R| + log|X'R^-1 X| + nu log N^2 + RSS/N^2)/2,  RSS = min |L^-1 (y - X b)|^2
//
// N is integrated out with a prior flat in log N above the anchor: the median of
// standard error^2 x duration where the windows state one, else zero. The stated error holds white
// noise only, so the real N may lie above it, never below. The shapes form a grid in the logarithms
// of B and K plus the corners where they are zero, as fine as their posterior asks for
// (shape_grid.hpp), weighed by what instruments do (noise_prior.hpp). beta and its covariance are
// averaged over the grid with the posterior weights, so that not knowing the noise widens the
// intervals.

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "model/noise/noise.hpp"
#include "model/noise/noise_shapes.hpp"

namespace fogbench::model {

/// Probability of a normal variable within two standard deviations.
inline constexpr double kTwoSigma = 0.9544997361036416;

/// log of the likelihood of a shape's whitened residual squares, N integrated out above the anchor:
///   -nu/2 log RSS + log P(nu/2, RSS/(2 anchor^2)),  P the regularised incomplete gamma function
/// From a table (exact to 1e-6) so that it costs little in simulations.
class ResidualEvidence {
 public:
  ResidualEvidence(double nu, double anchor);
  double operator()(double residual_squares) const;
  /// By how much it changes when the squares fall by the factors exp(log_ratio), many at once:
  /// logarithms of the factors in, changes out.
  void change(double residual_squares, Eigen::Ref<Eigen::ArrayXf> log_ratio) const;
  double nu() const { return nu_; }

 private:
  /// log P of the gamma function at these squares.
  double log_p(double log_squares) const;

  double nu_, anchor_;
  double first_ = 0.0;  ///< log of RSS where the table begins
  std::vector<double> table_;
};

struct GlsResult {
  Eigen::VectorXd beta;
  /// Averaged over the plausible noise models, their disagreement about beta included. NaN in the
  /// rows and columns of dependent columns of X, whose beta is 0.
  Eigen::MatrixXd covariance;
  /// beta +- factor x standard error holds 95.45 %: 2 unless the noise is white with few degrees
  /// of freedom (then Student's t).
  double coverage_factor = 2.0;
  double degrees_of_freedom = 0.0;
  NoiseEstimate noise;
  Eigen::VectorXd residual;            ///< y - X beta
  Eigen::VectorXd whitened;            ///< of the residual, under noise.noise
  Eigen::VectorXd standard_deviation;  ///< of each row, under noise.noise
};

/// Errors: kBadInput: as check_windows, sizes that do not fit, or not more rows than columns.
Result<GlsResult> gls(const Windows& windows, const Eigen::MatrixXd& x, const Eigen::VectorXd& y);
/// The same on shapes that were prepared once.
Result<GlsResult> gls(const NoiseShapes& shapes, const Eigen::MatrixXd& x,
                      const Eigen::VectorXd& y);

}  // namespace fogbench::model
