#pragma once
// What no effect of the catalogue explains, as a formula to start from: small expressions over the
// recorded variables (powers, roots, thresholds, exponentials, sines, bells, and products of two),
// at most three of them added up. A guess, and labelled as one.
//
//   gain(g)  = whitened squares that g explains beside the base      noise as gyros have it
//   score(g) = nu log(1 - gain/squares) + length(g) log(rows)        smallest wins
//
// The winner of each round has to predict blocks of rows that took no part in its fit.

#include <Eigen/Core>
#include <optional>
#include <string>

#include "model/diagnose/library.hpp"

namespace fogbench::model {

struct Formula {
  std::string
      expression;  ///< over the table's columns and what is derived from them (expression.hpp)
  double heldout_rms = 0.0;  ///< with it, its coefficient fitted
  double heldout_rms_without = 0.0;
};

/// `base` (what the model has, full rank) and `y` on the rows of the source's table. Nothing where
/// no expression predicts held-out rows better.
std::optional<Formula> search_formula(const LibrarySource& source, const Eigen::MatrixXd& base,
                                      const Eigen::VectorXd& y);

}  // namespace fogbench::model
