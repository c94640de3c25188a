#include "model/table/bad_rows.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <optional>

#include "model/fit/gls.hpp"

namespace fogbench::model {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kFewestFree = 20.0;
constexpr Index kRowsForEachBad = 25;
constexpr double kBadLevel = 0.001;
// Of a row's own pulse this part must be left by the columns, or the row alone carries a term.
constexpr double kLeastLeft = 0.5;
// Of the largest measurement: what is off by less is rounding.
constexpr double kRoundingShare = 1e-9;
constexpr Index kWidestPulse = 4;

/// What each row, alone or with those after it, takes off the squares of the residual.
struct Pulses {
  VectorXd gain;  ///< of each row by itself; 0 where a step or a longer pulse there takes off more
  VectorXd off;   ///< its least-squares size
  double squares = 0.0;
};

Pulses pulses_of(const Windows& windows, const Whitener& whitener, const MatrixXd& columns,
                 const VectorXd& y) {
  const Index n = y.size();
  const MatrixXd own = whitener.whiten(MatrixXd::Identity(n, n));
  MatrixXd u = own;
  VectorXd e = whitener.whiten(y);
  if (columns.cols() > 0) {
    const Eigen::ColPivHouseholderQR<MatrixXd> qr(whitener.whiten(columns));
    const MatrixXd q = qr.householderQ() * MatrixXd::Identity(n, qr.rank());
    u.noalias() -= q * (q.transpose() * own);
    e -= q * (q.transpose() * e).eval();
  }
  Pulses out{VectorXd::Zero(n), VectorXd::Zero(n), e.squaredNorm()};
  VectorXd wider = VectorXd::Zero(n);
  const auto gain_of = [&](const VectorXd& column) {
    const double squares = column.squaredNorm();
    return squares > 1e-9 ? std::pow(column.dot(e), 2) / squares : 0.0;
  };
  for (Index i = 0; i < n; ++i) {
    const double left = u.col(i).squaredNorm();
    if (left < kLeastLeft * own.col(i).squaredNorm()) continue;
    out.off[i] = u.col(i).dot(e) / left;
    out.gain[i] = gain_of(u.col(i));
  }
  for (std::size_t run = 0; run + 1 < windows.run_begin.size(); ++run) {
    const auto first = static_cast<Index>(windows.run_begin[run]);
    const auto last = static_cast<Index>(windows.run_begin[run + 1]);
    VectorXd step = VectorXd::Zero(n);
    for (Index i = last; i-- > first;) {
      step += u.col(i);
      // A step before the last row, or after the first, is that row's own pulse.
      if (i > first + 1 && i + 1 < last) {
        const double as_step = gain_of(step);
        wider[i] = std::max(wider[i], as_step);
        wider[i - 1] = std::max(wider[i - 1], as_step);
      }
      VectorXd pulse = u.col(i);
      for (Index j = i + 1; j < std::min(i + kWidestPulse, last); ++j) {
        pulse += u.col(j);
        const double as_pulse = gain_of(pulse);
        for (Index k = i; k <= j; ++k) wider[k] = std::max(wider[k], as_pulse);
      }
    }
  }
  out.gain = (out.gain.array() > wider.array()).select(out.gain, 0.0).eval();
  return out;
}

MatrixXd with_pulses(const MatrixXd& columns, const std::vector<BadRow>& bad) {
  MatrixXd out(columns.rows(), columns.cols() + static_cast<Index>(bad.size()));
  out << columns, MatrixXd::Zero(columns.rows(), static_cast<Index>(bad.size()));
  for (std::size_t i = 0; i < bad.size(); ++i) {
    out(bad[i].row, columns.cols() + static_cast<Index>(i)) = 1.0;
  }
  return out;
}

std::optional<BadRow> worst_row(const Windows& windows, const NoiseShapes& shapes,
                                const MatrixXd& columns, const VectorXd& y) {
  const auto fitted = gls(shapes, columns, y);
  if (!fitted || fitted->degrees_of_freedom < kFewestFree) return {};
  const NoiseCoefficients& noise = fitted->noise.noise;
  const double white = noise.angle_random_walk_deg_per_sqrt_h;
  const Pulses pulses = pulses_of(windows, *shapes.whitener(noise), columns, y);
  Index row = 0;
  const double gain = pulses.gain.maxCoeff(&row);
  // The size of the noise without this row, but not below what is stated.
  const double nu = fitted->degrees_of_freedom - 1.0;
  const double least = std::pow(shapes.anchor() / white, 2);
  const double variance = std::max((pulses.squares - gain) / nu, least);
  if (!(gain > 0.0) || !(variance > 0.0)) return {};
  const double sigmas = std::sqrt(gain / variance);
  const boost::math::students_t student(nu);
  const double p = 2.0 * static_cast<double>(y.size()) *
                   boost::math::cdf(boost::math::complement(student, sigmas));
  const double rounding = kRoundingShare * y.cwiseAbs().maxCoeff();
  if (p > kBadLevel || std::abs(pulses.off[row]) < rounding) return {};
  return BadRow{row, pulses.off[row], sigmas};
}

}  // namespace

std::vector<BadRow> find_bad_rows(const Windows& windows, const NoiseShapes& shapes,
                                  const MatrixXd& columns, const VectorXd& y) {
  std::vector<BadRow> bad;
  if (y.size() > kMostRowsToDoubt) return bad;
  const auto most = static_cast<std::size_t>(std::max<Index>(1, y.size() / kRowsForEachBad));
  while (const auto worst = worst_row(windows, shapes, with_pulses(columns, bad), y)) {
    const bool beside_another = std::any_of(bad.begin(), bad.end(), [&](const BadRow& other) {
      return std::abs(other.row - worst->row) < kWidestPulse;
    });
    if (bad.size() == most || beside_another) return {};
    bad.push_back(*worst);
  }
  return bad;
}

}  // namespace fogbench::model
