#pragma once
// Single rows that are off by far more than noise and that nothing around them shares: a bad
// reading, not an effect. They are looked for before anything else, since one of them is enough to
// make the noise look large, or an effect look wrong.
//
// Row i as a pulse of its own, u = (I - QQ')L^-1 e_i under the noise that suits the rest, takes
// (u'e)^2/u'u off the squares. A step in time or a pulse of a few rows that takes off more is not a
// bad row. Bonferroni over the rows.

#include <Eigen/Core>
#include <vector>

#include "model/noise/noise_shapes.hpp"

namespace fogbench::model {

/// One bad row among more than these cannot do much harm, and the search for it would take long.
inline constexpr Eigen::Index kMostRowsToDoubt = 1000;

struct BadRow {
  Eigen::Index row = 0;
  double off = 0.0;     ///< from what the other rows say of it, unit of the observable
  double sigmas = 0.0;  ///< the same over its standard deviation
};

/// In the order found, worst first; empty for fewer than 20 rows beside the columns, for more than
/// 1,000 rows, and where more than one row in 25 would have to go, or two that are neighbours: then
/// the noise has heavy tails, or something acts that is no bad reading.
std::vector<BadRow> find_bad_rows(const Windows& windows, const NoiseShapes& shapes,
                                  const Eigen::MatrixXd& columns, const Eigen::VectorXd& y);

}  // namespace fogbench::model
