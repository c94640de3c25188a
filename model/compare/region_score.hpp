#pragma once
// Does a region's offset exist, under coloured noise that is itself unknown? A region's indicator
// is a candidate like any other (diagnose/detector.hpp): the noise is estimated anew with every
// offset, so that a gap that repeats loop by loop is not taken for a random walk, and the same is
// done to draws of the plausible noise.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "model/noise/noise_shapes.hpp"

namespace fogbench::model {

struct RegionScores {
  /// Least-squares offset of each region under the noise that suits it best; empty when z is not
  /// from offsets but from mean residuals.
  Eigen::VectorXd offset;
  Eigen::VectorXd z;  ///< sqrt(Lambda), with the sign of the offset; 0 where nothing is left of it
  /// Per region, the chance that noise makes any region stand out as much.
  Eigen::VectorXd family_wise;
};

/// `x` the fitted columns (may have none), `indicators` one column a region, on the windows of
/// `shapes`: for up to about 1,000 windows.
RegionScores score_regions(const NoiseShapes& shapes, const Eigen::MatrixXd& x,
                           const Eigen::VectorXd& y, const Eigen::MatrixXd& indicators,
                           std::uint64_t seed);

}  // namespace fogbench::model
