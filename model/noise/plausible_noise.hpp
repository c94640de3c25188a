#pragma once
// What the plausible noise (NoiseEstimate) does to rows by chance.

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include "model/noise/noise_shapes.hpp"

namespace fogbench::model {

/// Draws of the plausible noise, one a column, each noise model as often as it is probable.
Eigen::MatrixXd draw_plausible_noise(const NoiseShapes& shapes, const NoiseEstimate& estimate,
                                     Eigen::Index draws, std::uint64_t seed);

/// RMS residual that this noise alone would leave once the columns have been fitted; the
/// observable's unit, NaN where nothing is known.
struct NoiseFloor {
  double white =
      std::numeric_limits<double>::quiet_NaN();  ///< without the slow noise; as stated, if it is
  double median = std::numeric_limits<double>::quiet_NaN();  ///< with it
  double low = std::numeric_limits<double>::quiet_NaN();     ///< 5 % of such records leave less
  double high = std::numeric_limits<double>::quiet_NaN();    ///< 5 % leave more

  /// What to hold an RMS of `left` against: the median, but no more than is there. A walk of the
  /// size that fits may by chance have wandered less than most do.
  double beside(double left) const;
  /// What of it is white, and between what the slow rest makes it wander.
  std::string parts_in_words(std::string_view unit) const;
};

/// On the first `rows` of the shapes' windows.
NoiseFloor noise_floor(const NoiseShapes& shapes, const NoiseEstimate& estimate,
                       const Eigen::MatrixXd& columns, Eigen::Index rows, std::uint64_t seed);

}  // namespace fogbench::model
