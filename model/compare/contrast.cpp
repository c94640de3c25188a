#include "model/compare/contrast.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "model/noise/noise.hpp"

namespace fogbench::model {

Result<double> contrast_standard_error(std::vector<WeightedWindow> windows, const FitResult& fit) {
  std::sort(windows.begin(), windows.end(),
            [](const auto& a, const auto& b) { return a.centre_s < b.centre_s; });
  const auto n = static_cast<Eigen::Index>(windows.size());
  Eigen::VectorXd weights(n);
  Windows at{.run_begin = {0, windows.size()},
             .centre_s = Eigen::VectorXd(n),
             .duration_s = Eigen::VectorXd(n),
             .white_floor = Eigen::VectorXd(n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    const WeightedWindow& window = windows[static_cast<std::size_t>(i)];
    weights[i] = window.weight;
    at.centre_s[i] = window.centre_s;
    at.duration_s[i] = window.duration_s;
    at.white_floor[i] = window.rate_std_error_deg_per_h;
  }
  if (!fit.coloured) return fit.residual_standard_deviation * weights.norm();
  auto shapes = fit.noise.plausible;
  if (shapes.empty()) shapes.emplace_back(fit.noise.noise, 1.0);
  double variance = 0.0;
  for (const auto& [noise, share] : shapes) {
    const auto omega = noise_covariance(at, noise);
    if (!omega) return omega.error();
    variance += share * weights.dot(*omega * weights);
  }
  return std::sqrt(std::max(variance, 0.0));
}

}  // namespace fogbench::model
