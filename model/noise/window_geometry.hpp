#pragma once
// What the noise of window averages takes from the windows alone, computed once and shared by all
// noise models on them: the ladder of correlation times, and for each window and each correlation
// time the integrals of the exponential.
//
// For a unit Ornstein-Uhlenbeck process s with correlation time tau over a window of length d,
// x = d/tau:
//   mean given the start:    phi(x) s,    phi = (1 - exp(-x))/x
//   variance of the mean:    psi(x) = 2 (x - 1 + exp(-x))/x^2
//   covariance of two means: exp(-gap/tau) phi(x1) phi(x2)

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "model/noise/noise.hpp"

namespace fogbench::model {

/// (1 - exp(-x))/x, exact near 0 too.
double decay_mean(double x);
/// 2 (x - 1 + exp(-x))/x^2, exact near 0 too.
double decay_double_mean(double x);

/// The correlation times that stand for flicker noise on these windows: from a tenth of the
/// shortest window to ten times the longest run, 6 to 9 of them.
struct FlickerLadder {
  std::vector<double> tau_s;
  double variance_per_b2 = 0.0;  ///< ln(r)/pi: variance of each term over B^2

  static FlickerLadder for_windows(const Windows& windows);
};

/// Arrays have one column a window, one row a correlation time.
struct WindowGeometry {
  FlickerLadder ladder;
  std::vector<std::size_t> run_begin;
  Eigen::ArrayXXd phi;         ///< of the window
  Eigen::ArrayXXd decay;       ///< from the window's start to the next window's start
  Eigen::ArrayXXd end_cov;     ///< of the noise in the next start and in the mean, per variance
  Eigen::ArrayXd mean_spread;  ///< sum over the ladder of psi - phi^2
  Eigen::ArrayXd mean_total;   ///< sum over the ladder of psi
  Eigen::ArrayXd duration_h;
  Eigen::ArrayXd white_per_n2;  ///< white variance of the window for N = 1 deg/sqrt(h)
  Eigen::ArrayXd start_h;       ///< of the window, since the run's start
  Eigen::ArrayXd step_h;        ///< from the window's start to the next window's start

  Eigen::Index rows() const { return duration_h.size(); }

  /// Errors as check_windows.
  static Result<std::shared_ptr<const WindowGeometry>> make(const Windows& windows);
};

/// As in noise.hpp, on windows that were prepared once. Precondition: valid coefficients.
std::unique_ptr<Whitener> make_whitener(std::shared_ptr<const WindowGeometry> geometry,
                                        const NoiseCoefficients& noise);

}  // namespace fogbench::model
