#include "model/fit/reduction.hpp"

#include <Eigen/QR>
#include <cmath>

namespace fogbench::model {
namespace {

Eigen::MatrixXd triangle_of(const Eigen::MatrixXd& rows) {
  const Eigen::Index n = rows.cols();
  Eigen::HouseholderQR<Eigen::MatrixXd> qr(rows);
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(n, n);
  const Eigen::Index height = std::min(rows.rows(), n);
  result.topRows(height) = qr.matrixQR().topRows(height).triangularView<Eigen::Upper>();
  return result;
}

Eigen::VectorXd column_norms(const Eigen::MatrixXd& matrix) {
  Eigen::VectorXd norms = matrix.colwise().stableNorm().transpose();
  for (double& norm : norms) norm = norm > 0.0 ? norm : 1.0;
  return norms;
}

}  // namespace

Reduction::Reduction(Eigen::Index columns) : triangle_(Eigen::MatrixXd::Zero(columns, columns)) {}

void Reduction::add(const Eigen::Ref<const Eigen::MatrixXd>& rows) {
  Eigen::MatrixXd stacked(triangle_.rows() + rows.rows(), triangle_.cols());
  stacked << triangle_, rows;
  triangle_ = triangle_of(stacked);
}

std::vector<Eigen::Index> independent_columns(const Eigen::MatrixXd& columns, Eigen::Index count,
                                              double dependent) {
  if (count == 0) return {};
  const Eigen::MatrixXd triangle = triangle_of(columns);
  std::vector<Eigen::Index> kept;
  const Eigen::VectorXd norms = column_norms(triangle);
  Eigen::MatrixXd chosen(triangle.rows(), 0);
  for (Eigen::Index j = 0; j < count; ++j) {
    Eigen::MatrixXd trial(triangle.rows(), chosen.cols() + 1);
    trial << chosen, triangle.col(j) / norms[j];
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(trial);
    qr.setThreshold(dependent);
    if (qr.rank() < trial.cols()) continue;
    chosen = std::move(trial);
    kept.push_back(j);
  }
  return kept;
}

Eigen::MatrixXd inverse_gram(const Eigen::MatrixXd& triangle) {
  const Eigen::VectorXd norms = column_norms(triangle);
  const Eigen::MatrixXd scaled = triangle * norms.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd inverse = scaled.triangularView<Eigen::Upper>().solve(
      Eigen::MatrixXd::Identity(triangle.rows(), triangle.cols()));
  const Eigen::MatrixXd unscaled = norms.cwiseInverse().asDiagonal() * inverse;
  return unscaled * unscaled.transpose();
}

LinearFit fit_triangle(const Eigen::MatrixXd& triangle, Eigen::Index p,
                       const std::vector<Tangent>& tangents, Eigen::Index parameters) {
  LinearFit fit;
  fit.kept = independent_columns(triangle, p);
  fit.beta = Eigen::VectorXd::Zero(p);
  const auto kept = static_cast<Eigen::Index>(fit.kept.size());
  const Eigen::VectorXd y = triangle.col(triangle.cols() - 1);
  const Eigen::MatrixXd x = triangle(Eigen::all, fit.kept);
  const Eigen::VectorXd norms = column_norms(x);
  const Eigen::MatrixXd scaled = x * norms.cwiseInverse().asDiagonal();
  if (kept > 0) {
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(scaled);
    fit.beta(fit.kept) = qr.solve(y).cwiseQuotient(norms);
    for (Eigen::Index j = 0, next = 0; j < p; ++j) {
      if (next < kept && fit.kept[static_cast<std::size_t>(next)] == j) {
        ++next;
        continue;
      }
      const Eigen::VectorXd share = qr.solve(triangle.col(j));
      const double length = triangle.col(j).norm();
      fit.dependent.push_back({j});
      for (Eigen::Index i = 0; i < kept; ++i) {
        if (std::abs(share[i]) > 1e-6 * length) {
          fit.dependent.back().push_back(fit.kept[static_cast<std::size_t>(i)]);
        }
      }
    }
  } else {
    for (Eigen::Index j = 0; j < p; ++j) fit.dependent.push_back({j});
  }

  const Eigen::Index q = tangents.empty() ? 0 : parameters;
  Eigen::MatrixXd joint = Eigen::MatrixXd::Zero(triangle.rows(), kept + q + 1);
  joint.leftCols(kept) = x;
  for (std::size_t i = 0; i < tangents.size(); ++i) {
    const Tangent& tangent = tangents[i];
    const double coefficient = tangent.column < 0 ? tangent.held : fit.beta[tangent.column];
    joint.col(kept + tangent.parameter) +=
        coefficient * triangle.col(p + static_cast<Eigen::Index>(i));
  }
  joint.col(kept + q) = y;
  fit.joint = triangle_of(joint);
  fit.residual_sum_of_squares = fit.joint.col(kept + q).tail(q + 1).squaredNorm();
  return fit;
}

}  // namespace fogbench::model
