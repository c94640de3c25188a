#pragma once
// Least squares from any number of rows through one small triangle.
//
// Blocks of rows are reduced by Householder QR as they come (R of the stacked rows), so that a
// table of any length needs memory for one block. The triangle of [X D y] then answers everything:
// the coefficients, the residual, and, with D the derivatives of the columns of X by the inner
// parameters, the step of those.

#include <Eigen/Core>
#include <vector>

namespace fogbench::model {

/// Accumulates R of the QR decomposition of all rows added.
class Reduction {
 public:
  explicit Reduction(Eigen::Index columns);
  void add(const Eigen::Ref<const Eigen::MatrixXd>& rows);
  /// Upper triangular, columns x columns.
  const Eigen::MatrixXd& triangle() const { return triangle_; }

 private:
  Eigen::MatrixXd triangle_;
};

/// One derivative column: of which inner parameter, times which coefficient.
struct Tangent {
  Eigen::Index parameter = 0;
  Eigen::Index column = -1;  ///< the free column of X whose coefficient multiplies it; -1: held
  double held = 0.0;         ///< the coefficient when held
};

/// The linear fit within a triangle of [X (p columns) | D | y].
struct LinearFit {
  std::vector<Eigen::Index> kept;  ///< independent columns of X, the earlier ones first
  Eigen::VectorXd beta;            ///< p, zero where not kept
  /// For each column that was left out: it and the kept columns that it is a sum of.
  std::vector<std::vector<Eigen::Index>> dependent;
  /// Triangle of [X kept | T | y] with T = dy/da, the tangents of the inner parameters (none when
  /// the triangle has no D).
  Eigen::MatrixXd joint;
  double residual_sum_of_squares = 0.0;
};

LinearFit fit_triangle(const Eigen::MatrixXd& triangle, Eigen::Index p,
                       const std::vector<Tangent>& tangents, Eigen::Index parameters);

/// Of the first `count` columns those that are independent, each judged after those before it; the
/// norm of a column is its scale. By default only rounding makes it dependent: a sum of others
/// keeps some hundred roundings of its length.
std::vector<Eigen::Index> independent_columns(const Eigen::MatrixXd& columns, Eigen::Index count,
                                              double dependent = 1e-13);

/// (R'R)^-1 for a square triangle of full rank, scaled column by column on the way.
Eigen::MatrixXd inverse_gram(const Eigen::MatrixXd& triangle);

}  // namespace fogbench::model
