#pragma once
// Does a region's offset exist, under coloured noise that is itself unknown?
//
// For region g and noise shape k, u = (I - QQ')L^-1 w_g is what the model leaves of the region's
// indicator after whitening, e the whitened residual; an offset takes (u'e)^2/u'u off the residual
// squares. Summed over the shapes with the evidence that each residual gives them,
//   Lambda_g = 2 [log sum_k evidence_k(RSS_k - (u'e)^2/u'u) - log sum_k evidence_k(RSS_k)],
// so the noise is estimated anew with every offset: a gap that repeats loop by loop is not taken
// for a random walk. Its null distribution comes from draws of the plausible noise, each of them
// treated in the same way.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "model/gls.hpp"

namespace fogbench::model {

struct RegionScores {
  /// Least-squares offset of each region under the most credible noise; empty when z is not from
  /// offsets but from mean residuals.
  Eigen::VectorXd offset;
  Eigen::VectorXd z;  ///< sqrt(Lambda), with the sign of the offset; 0 where nothing is left of it
  /// Per region, the chance that noise makes the largest |z| of all at least that large.
  Eigen::VectorXd family_wise;
};

/// `x` the fitted columns (may have none), `indicators` one column a region, on the windows of
/// `shapes`. About 100 n operations for each shape and draw: for up to about 1,000 windows.
RegionScores score_regions(const NoiseShapes& shapes, const Eigen::MatrixXd& x,
                           const Eigen::VectorXd& y, const Eigen::MatrixXd& indicators,
                           const NoiseEstimate& estimate, std::uint64_t seed);

}  // namespace fogbench::model
