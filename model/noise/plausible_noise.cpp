#include "model/noise/plausible_noise.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <cmath>
#include <vector>

#include "config/rounding.hpp"

namespace fogbench::model {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr Index kFloorDraws = 400;
constexpr double kLowShare = 0.05;

/// Calls `each(noise, first, count)` for each plausible noise and its share of the draws.
template <class Each>
void share_out(const NoiseEstimate& estimate, Index draws, const Each& each) {
  double reached = 0.0;
  Index first = 0;
  for (std::size_t i = 0; i < estimate.plausible.size() && first < draws; ++i) {
    const auto& [noise, weight] = estimate.plausible[i];
    reached += weight;
    const Index last = i + 1 == estimate.plausible.size()
                           ? draws
                           : static_cast<Index>(std::lround(reached * static_cast<double>(draws)));
    if (last > first) each(noise, first, last - first);
    first = std::max(first, last);
  }
}

MatrixXd unit_normals(Index rows, Index columns, std::uint64_t seed) {
  boost::random::mt19937_64 engine(seed);
  boost::random::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(rows, columns, [&](Index, Index) { return normal(engine); });
}

/// RMS of the first rows of each column once `columns` have been fitted to it.
VectorXd rms_left(const Whitener& whitener, const MatrixXd& columns, MatrixXd noise, Index rows) {
  if (columns.cols() > 0) {
    const Eigen::ColPivHouseholderQR<MatrixXd> qr(whitener.whiten(columns));
    noise -= columns * qr.solve(whitener.whiten(noise));
  }
  return (noise.topRows(rows).colwise().squaredNorm() / static_cast<double>(rows)).cwiseSqrt();
}

}  // namespace

MatrixXd draw_plausible_noise(const NoiseShapes& shapes, const NoiseEstimate& estimate, Index draws,
                              std::uint64_t seed) {
  MatrixXd out = unit_normals(shapes.rows(), draws, seed);
  share_out(estimate, draws, [&](const NoiseCoefficients& noise, Index first, Index count) {
    out.middleCols(first, count) = shapes.whitener(noise)->colour(out.middleCols(first, count));
  });
  return out;
}

double NoiseFloor::beside(double left) const {
  return std::isfinite(left) ? std::min(median, left) : median;
}

std::string NoiseFloor::parts_in_words(std::string_view unit) const {
  return fmt::format("its white part {} {}, with slow noise {} to {} in 9 of 10 records",
                     config::significant(white, 3), unit, config::significant(low, 3),
                     config::significant(high, 3));
}

NoiseFloor noise_floor(const NoiseShapes& shapes, const NoiseEstimate& estimate,
                       const MatrixXd& columns, Index rows, std::uint64_t seed) {
  const MatrixXd noise = draw_plausible_noise(shapes, estimate, kFloorDraws, seed);
  std::vector<double> all;
  double white = 0.0;
  share_out(estimate, kFloorDraws, [&](const NoiseCoefficients& its, Index first, Index count) {
    const VectorXd rms =
        rms_left(*shapes.whitener(its), columns, noise.middleCols(first, count), rows);
    all.insert(all.end(), rms.begin(), rms.end());
    white += static_cast<double>(count) * its.angle_random_walk_deg_per_sqrt_h *
             its.angle_random_walk_deg_per_sqrt_h;
  });
  NoiseFloor out;
  if (all.empty()) return out;
  std::sort(all.begin(), all.end());
  const auto at = [&](double share) {
    return all[static_cast<std::size_t>(share * static_cast<double>(all.size() - 1))];
  };
  out.median = at(0.5);
  out.low = at(kLowShare);
  out.high = at(1.0 - kLowShare);
  white /= static_cast<double>(kFloorDraws);
  // What states its errors has said how large it is; a misfit may have swollen the estimate.
  if (shapes.anchor() > 0.0) white = shapes.anchor() * shapes.anchor();
  // Each fitted column takes its share of the white noise away.
  const VectorXd unit = shapes.whitener(0)->standard_deviation();
  const double left =
      std::max(0.0, 1.0 - static_cast<double>(columns.cols()) / static_cast<double>(shapes.rows()));
  out.white = std::sqrt(white * left * unit.head(rows).squaredNorm() / static_cast<double>(rows));
  return out;
}

}  // namespace fogbench::model
