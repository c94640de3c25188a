#pragma once
// The shapes of coloured noise that a fit or a diagnosis tries: ratios of flicker and walk to white
// noise, on a grid of logarithms and at zero.

#include <memory>
#include <vector>

#include "model/noise/noise.hpp"
#include "model/noise/noise_prior.hpp"

namespace fogbench::model {

struct WindowGeometry;

/// Values of B/N or K/N that are tried: zero, and `count` from `least` on, exp(step) apart.
struct RatioAxis {
  double least = 1.0, step = 1.0;
  int count = 1;
  double log_prior_of_zero = 0.0;  ///< of all that is too small to show
};

/// The grid of noise shapes on given windows, in units of N; shape_grid.hpp makes it finer where
/// that is called for. Whiteners are made once and kept where the rows are few, so that hundreds of
/// candidate models on one table cost little each.
class NoiseShapes {
 public:
  /// Errors as check_windows.
  static Result<NoiseShapes> make(const Windows& windows, const NoisePrior& prior = {});

  std::size_t size() const { return shapes_.size(); }
  Eigen::Index rows() const { return rows_; }
  /// With N = 1 deg/sqrt(h). Shape 0 is white; the values of K run first.
  const NoiseCoefficients& shape(std::size_t i) const { return shapes_[i]; }
  const RatioAxis& b_over_n() const { return b_over_n_; }
  const RatioAxis& k_over_n() const { return k_over_n_; }
  const NoisePrior& prior() const { return prior_; }
  std::shared_ptr<const Whitener> whitener(std::size_t i) const;
  /// Whitener of any noise on the same windows.
  std::unique_ptr<Whitener> whitener(const NoiseCoefficients& noise) const;
  /// Lower bound of N from the stated standard errors or the prior; 0 where there are none.
  double anchor() const { return anchor_; }

 private:
  std::shared_ptr<const WindowGeometry> geometry_;
  NoisePrior prior_;
  std::vector<NoiseCoefficients> shapes_;
  RatioAxis b_over_n_, k_over_n_;
  std::vector<std::shared_ptr<const Whitener>> kept_;
  Eigen::Index rows_ = 0;
  double anchor_ = 0.0;
};

}  // namespace fogbench::model
