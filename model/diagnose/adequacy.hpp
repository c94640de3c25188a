#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "model/diagnose/detector.hpp"

namespace fogbench::model {

struct Adequacy {
  double p_value = 1.0;
  std::vector<std::string> depends_on;  ///< the worst variables, at most three
};

/// Does anything smooth in any variable remain beside `base`, or are the innovations of the noise
/// not white, as when a walk has swallowed an effect? `smooth`: make_smooth_library(). The
/// noise is held as it is without them: estimated again under wide bases, it would pass structure
/// off as noise, and noise as structure.
Adequacy check_adequacy(const NoiseShapes& shapes, const Eigen::MatrixXd& base,
                        const Eigen::VectorXd& y, const Library& smooth, std::uint64_t seed);

}  // namespace fogbench::model
