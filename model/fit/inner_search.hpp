#pragma once
// Inner parameters by variable projection.
//
// At inner parameters a the coefficients are a linear fit, so the search is over a alone:
//   minimise |r(a)|^2,  r(a) = y - X(a) beta(a),  dr/da = -(I - P) T,  T = sum beta dX/da
// (Kaufman's form of the derivative; the gradient is exact). The triangle of [X | T | y] holds both
// r and dr/da up to a common rotation in its last rows, so Ceres is given q + 1 residuals whatever
// the number of rows.

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "config/result.hpp"
#include "model/fit/observations.hpp"

namespace fogbench::model {

struct InnerSolution {
  Eigen::VectorXd inner;
  LinearFit fit;  ///< with tangents, at these parameters
};

/// Starts from the given values; where none is given, from the best of a grid over the typical
/// range. Errors: kBadInput: a term is not a number at the starting values.
Result<InnerSolution> search_inner(const Observations& observations);
/// The same from a point near the solution.
Result<InnerSolution> refine_inner(const Observations& observations, const Eigen::VectorXd& start);
/// The linear fit alone, without tangents; nothing when a term is not finite there.
std::optional<LinearFit> linear_fit_at(const Observations& observations,
                                       const Eigen::VectorXd& inner);
/// Says which term is not finite at these parameters.
Error not_finite_at(const Observations& observations, const Eigen::VectorXd& inner);

}  // namespace fogbench::model
