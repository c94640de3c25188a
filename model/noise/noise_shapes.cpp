#include "model/noise/noise_shapes.hpp"

#include <algorithm>
#include <cmath>

#include "model/noise/stated_errors.hpp"
#include "model/noise/window_geometry.hpp"
#include "model/table/median.hpp"

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

/// `least`, `most`: what the windows could just show, and where white noise no longer matters. What
/// no instrument does is not on the grid.
RatioAxis axis_of(const NoisePrior::Ratio& prior, double least, double most, int count) {
  most = std::min(most, prior.most());
  least = std::min(std::max(least, prior.median * std::pow(10.0, -3.0 * prior.decades)),
                   most / kLeastSpan);
  const double step = std::log(most / least) / (count - 1);
  return {least, step, count, prior.log_below(least * std::exp(-0.5 * step))};
}

std::vector<double> values_of(const RatioAxis& axis) {
  std::vector<double> out{0.0};
  for (int i = 0; i < axis.count; ++i) out.push_back(axis.least * std::exp(axis.step * i));
  return out;
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
  out.b_over_n_ = axis_of(prior.b_over_n, 1.0 / std::sqrt(rows * window_h),
                          kMostFlickerPerWindow / std::sqrt(window_h), kFlickerShapes);
  out.k_over_n_ = axis_of(prior.k_over_n, kLeastWalkPerRun / run_h, kMostWalkPerRow * rows / run_h,
                          kWalkShapes);
  for (const double b : values_of(out.b_over_n_)) {
    for (const double k : values_of(out.k_over_n_)) {
      out.shapes_.push_back({.angle_random_walk_deg_per_sqrt_h = 1.0,
                             .bias_instability_deg_per_h = b,
                             .rate_random_walk_deg_per_h_per_sqrt_h = k});
    }
  }
  if (out.rows_ <= kMostRowsKept) {
    for (const NoiseCoefficients& shape : out.shapes_) {
      out.kept_.push_back(make_whitener(out.geometry_, shape));
    }
  }
  return out;
}

std::shared_ptr<const Whitener> NoiseShapes::whitener(std::size_t i) const {
  if (!kept_.empty()) return kept_[i];
  return make_whitener(geometry_, shapes_[i]);
}

std::unique_ptr<Whitener> NoiseShapes::whitener(const NoiseCoefficients& noise) const {
  return make_whitener(geometry_, noise);
}

}  // namespace fogbench::model
