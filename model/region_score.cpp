#include "model/region_score.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>

namespace fogbench::model {
namespace {

using Eigen::ArrayXd;
using Eigen::ArrayXXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kMostDraws = 999;
constexpr double kOperations = 4e9;   // in all draws: under two seconds
constexpr Index kDrawsAtATime = 128;  // draws at a time: what is made of them stays in the cache
// Of a region's indicator this part must be left after the fitted columns, or nothing can be said.
constexpr double kLeastRemaining = 1e-3;

/// log sum exp, term by term, of a table of numbers.
class LogSum {
 public:
  LogSum(Index rows, Index columns)
      : top_(ArrayXXd::Constant(rows, columns, -std::numeric_limits<double>::infinity())),
        sum_(ArrayXXd::Zero(rows, columns)) {}

  void add(Index row, Index column, double term) {
    double& top = top_(row, column);
    double& sum = sum_(row, column);
    if (term > top) {
      sum = sum * std::exp(top - term) + 1.0;
      top = term;
    } else if (term > top - kNothing) {
      sum += std::exp(term - top);
    }
  }

  ArrayXXd value() const { return top_ + sum_.log(); }

 private:
  static constexpr double kNothing = 40.0;  // e^-40 of the largest term is below its rounding
  ArrayXXd top_, sum_;
};

/// Draws of the plausible noise, one a column.
MatrixXd draw_noise(const NoiseShapes& shapes, const NoiseEstimate& estimate, Index draws,
                    std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  MatrixXd out = MatrixXd::NullaryExpr(shapes.rows(), draws, [&] { return normal(random); });
  double reached = 0.0;
  Index first = 0;
  for (std::size_t i = 0; i < estimate.plausible.size() && first < draws; ++i) {
    const auto& [noise, weight] = estimate.plausible[i];
    reached += weight;
    const Index last = i + 1 == estimate.plausible.size()
                           ? draws
                           : static_cast<Index>(std::lround(reached * static_cast<double>(draws)));
    if (last <= first) continue;
    out.middleCols(first, last - first) =
        shapes.whitener(noise)->colour(out.middleCols(first, last - first));
    first = last;
  }
  return out;
}

}  // namespace

RegionScores score_regions(const NoiseShapes& shapes, const MatrixXd& x, const VectorXd& y,
                           const MatrixXd& indicators, const NoiseEstimate& estimate,
                           std::uint64_t seed) {
  const Index n = shapes.rows(), regions = indicators.cols();
  const double per_draw = static_cast<double>(n) * static_cast<double>(shapes.size()) *
                          static_cast<double>(40 + 2 * regions);
  const Index draws =
      std::clamp(static_cast<Index>(kOperations / per_draw), Index{199}, kMostDraws);
  MatrixXd data(n, draws + 1);  // the measurements, then the draws
  data.col(0) = y;
  data.rightCols(draws) = draw_noise(shapes, estimate, draws, seed);

  LogSum without(1, draws + 1), with(regions, draws + 1);
  VectorXd offset = VectorXd::Zero(regions);
  double best = -std::numeric_limits<double>::infinity();
  std::optional<ResidualEvidence> evidence;
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    const auto whitener = shapes.whitener(k);
    MatrixXd u = whitener->whiten(indicators);
    const VectorXd whole = u.colwise().norm();
    double log_determinant = 0.5 * whitener->log_determinant();
    MatrixXd q(n, 0);
    if (x.cols() > 0) {
      const Eigen::ColPivHouseholderQR<MatrixXd> qr(whitener->whiten(x));
      q = qr.householderQ() * MatrixXd::Identity(n, qr.rank());
      u -= q * (q.transpose() * u);
      log_determinant += qr.matrixQR().diagonal().head(qr.rank()).array().abs().log().sum();
    }
    VectorXd scale = u.colwise().norm();
    for (Index g = 0; g < regions; ++g) {
      scale[g] = scale[g] > kLeastRemaining * whole[g] ? 1.0 / scale[g] : 0.0;
    }
    u *= scale.asDiagonal();
    const auto nu = static_cast<double>(n - q.cols());
    if (!evidence || evidence->nu() != nu) evidence.emplace(nu, shapes.anchor());
    const double base = shapes.log_prior(k) - log_determinant;
    for (Index first = 0; first <= draws; first += kDrawsAtATime) {
      MatrixXd e =
          whitener->whiten(data.middleCols(first, std::min(kDrawsAtATime, draws + 1 - first)));
      if (q.cols() > 0) e -= q * (q.transpose() * e);
      const MatrixXd score = u.transpose() * e;
      for (Index i = 0; i < e.cols(); ++i) {
        const double squares = e.col(i).squaredNorm();
        const double weight = base + (*evidence)(squares);
        without.add(0, first + i, weight);
        for (Index g = 0; g < regions; ++g) {
          with.add(g, first + i, base + (*evidence)(squares - score(g, i) * score(g, i)));
        }
        if (first + i == 0 && weight > best) {
          best = weight;
          offset = score.col(0).cwiseProduct(scale);
        }
      }
    }
  }
  const ArrayXXd z = (2.0 * (with.value() - without.value().replicate(regions, 1))).max(0.0).sqrt();
  RegionScores out;
  out.offset = offset;
  out.z = offset.unaryExpr([](double d) { return d < 0.0 ? -1.0 : 1.0; })
              .cwiseProduct(z.col(0).matrix());
  out.family_wise = VectorXd(regions);
  const ArrayXd largest = z.rightCols(draws).colwise().maxCoeff().transpose();
  for (Index g = 0; g < regions; ++g) {
    const auto at_least = static_cast<double>((largest >= z(g, 0)).count());
    out.family_wise[g] =
        z(g, 0) > 0.0 ? (1.0 + at_least) / (1.0 + static_cast<double>(draws)) : 1.0;
  }
  return out;
}

}  // namespace fogbench::model
