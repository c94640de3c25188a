#include <algorithm>
#include <cmath>

#include "model/gls.hpp"
#include "model/median.hpp"
#include "model/stated_errors.hpp"
#include "model/window_geometry.hpp"

namespace fogbench::model {
namespace {

constexpr int kFlickerShapes = 8;  // with the zero: 9 x 8 = 72 shapes
constexpr int kWalkShapes = 7;
constexpr Eigen::Index kMostRowsKept = 4000;  // the gains of 72 shapes then take 20 MB
// The grid's ends. Flicker: from what a mean over the whole record could just show beside white
// noise to where white noise no longer matters in one window. Walk: likewise over the whole run.
constexpr double kMostFlickerPerWindow = 30.0;
constexpr double kLeastWalkPerRun = 1.0;
constexpr double kMostWalkPerRow = 3.0;
constexpr double kLeastSpan = 10.0;

/// A ratio's values on the grid, zero first, each with the prior probability of its cell.
struct Axis {
  std::vector<double> value, log_prior;
  double step = 1.0;
};

/// `least`, `most`: what the windows could just show, and where white noise no longer matters. What
/// no instrument does is not on the grid.
Axis axis_of(const NoisePrior::Ratio& prior, double least, double most, int count) {
  most = std::min(most, prior.most());
  least = std::min(std::max(least, prior.median * std::pow(10.0, -3.0 * prior.decades)),
                   most / kLeastSpan);
  Axis axis;
  axis.step = std::pow(most / least, 1.0 / (count - 1));
  axis.value.push_back(0.0);
  axis.log_prior.push_back(prior.log_below(least / std::sqrt(axis.step)));
  for (int i = 0; i < count; ++i) {
    axis.value.push_back(least * std::pow(axis.step, i));
    axis.log_prior.push_back(prior.log_density(axis.value.back()) + std::log(std::log(axis.step)));
  }
  return axis;
}

}  // namespace

Result<NoiseShapes> NoiseShapes::make(const Windows& windows, const NoisePrior& prior) {
  auto geometry = WindowGeometry::make(windows);
  if (!geometry) return geometry.error();
  NoiseShapes out;
  out.geometry_ = *geometry;
  out.rows_ = windows.rows();
  out.prior_ = prior;
  out.anchor_ = std::max(stated_white(windows), prior.least_white);

  const Eigen::ArrayXd& durations = out.geometry_->duration_h;
  const double window_h = median({durations.begin(), durations.end()});
  const double run_h = (out.geometry_->start_h + durations).maxCoeff();
  const double rows = static_cast<double>(out.rows_);
  const Axis flicker = axis_of(prior.b_over_n, 1.0 / std::sqrt(rows * window_h),
                               kMostFlickerPerWindow / std::sqrt(window_h), kFlickerShapes);
  const Axis walk = axis_of(prior.k_over_n, kLeastWalkPerRun / run_h,
                            kMostWalkPerRow * rows / run_h, kWalkShapes);
  out.step_of_b_ = flicker.step;
  out.step_of_k_ = walk.step;
  out.log_prior_without_b_ = flicker.log_prior.front();
  out.log_prior_without_k_ = walk.log_prior.front();
  for (std::size_t b = 0; b < flicker.value.size(); ++b) {
    for (std::size_t k = 0; k < walk.value.size(); ++k) {
      out.shapes_.push_back({.angle_random_walk_deg_per_sqrt_h = 1.0,
                             .bias_instability_deg_per_h = flicker.value[b],
                             .rate_random_walk_deg_per_h_per_sqrt_h = walk.value[k]});
      out.log_prior_.push_back(flicker.log_prior[b] + walk.log_prior[k]);
    }
  }
  if (out.rows_ <= kMostRowsKept) {
    for (const NoiseCoefficients& shape : out.shapes_) {
      out.kept_.push_back(make_whitener(out.geometry_, shape));
    }
  }
  return out;
}

double NoiseShapes::log_prior(const NoiseCoefficients& shape) const {
  const auto of = [](const NoisePrior::Ratio& ratio, double value, double step, double without) {
    return value == 0.0 ? without : ratio.log_density(value) + std::log(std::log(step));
  };
  return of(prior_.b_over_n, shape.bias_instability_deg_per_h, step_of_b_, log_prior_without_b_) +
         of(prior_.k_over_n, shape.rate_random_walk_deg_per_h_per_sqrt_h, step_of_k_,
            log_prior_without_k_);
}

std::shared_ptr<const Whitener> NoiseShapes::whitener(std::size_t i) const {
  if (!kept_.empty()) return kept_[i];
  return make_whitener(geometry_, shapes_[i]);
}

std::unique_ptr<Whitener> NoiseShapes::whitener(const NoiseCoefficients& noise) const {
  return make_whitener(geometry_, noise);
}

}  // namespace fogbench::model
