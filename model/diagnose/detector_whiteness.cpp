// Are the innovations white? What a random walk or flicker has swallowed leaves them correlated.

#include "model/diagnose/detector_view.hpp"

namespace fogbench::model {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr Index kMostLags = 20;
constexpr Index kRowsALag = 5;
// Shapes that weigh less in a draw do not move its statistic.
constexpr double kLeastShareOfDraw = 0.01;

/// Ljung and Box: n (n + 2) sum over the lags of r^2 / (n - lag), of positive correlations alone.
/// Neighbours that differ too much share a rounded angle (quantisation noise of IEEE 952): that
/// hides nothing, and makes what is said of the rest cautious.
double portmanteau(const Eigen::Ref<const Eigen::VectorXf>& e) {
  const Index n = e.size(), lags = std::min(kMostLags, n / kRowsALag);
  const double squares = std::max(static_cast<double>(e.squaredNorm()), kLeastSquares);
  double sum = 0.0;
  for (Index lag = 1; lag <= lags; ++lag) {
    const double r = static_cast<double>(e.head(n - lag).dot(e.tail(n - lag))) / squares;
    if (r > 0.0) sum += r * r / static_cast<double>(n - lag);
  }
  return static_cast<double>(n) * static_cast<double>(n + 2) * sum;
}

}  // namespace

VectorXd Detector::whiteness(const Draws& draws) const {
  VectorXd out = VectorXd::Zero(draws.count);
  in_parallel(static_cast<std::size_t>(draws.count), [&](std::size_t draw) {
    const auto b = static_cast<Index>(draw);
    std::vector<double> weight(views_.size());
    for (std::size_t v = 0; v < views_.size(); ++v) {
      const double squares = static_cast<double>(draws.residuals[v].col(b).squaredNorm());
      weight[v] = views_[v]->log_prior + evidence_(std::max(squares, kLeastSquares));
    }
    const double total = log_sum_exp(weight);
    for (std::size_t v = 0; v < views_.size(); ++v) {
      const double share = std::exp(weight[v] - total);
      if (share > kLeastShareOfDraw) out[b] += share * portmanteau(draws.residuals[v].col(b));
    }
  });
  return out;
}

double Detector::observed_whiteness() const {
  return whiteness(data_as_draw())[0];
}

}  // namespace fogbench::model
