#include <algorithm>
#include <cmath>

#include "model/gls.hpp"
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
constexpr double kPriorPowerOfWalk = 0.5;

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Row by row the stated errors scatter and hide bad rows; their median is one solid number.
double anchor_of(const Windows& windows) {
  std::vector<double> squares;
  for (Eigen::Index i = 0; i < windows.white_floor.size(); ++i) {
    const double error = windows.white_floor[i];
    if (error > 0.0 && std::isfinite(error)) {
      squares.push_back(error * error * windows.duration_s[i] / 3600.0);
    }
  }
  return squares.empty() ? 0.0 : std::sqrt(median(std::move(squares)));
}

}  // namespace

Result<NoiseShapes> NoiseShapes::make(const Windows& windows) {
  auto geometry = WindowGeometry::make(windows);
  if (!geometry) return geometry.error();
  NoiseShapes out;
  out.geometry_ = *geometry;
  out.rows_ = windows.rows();
  out.anchor_ = anchor_of(windows);

  const Eigen::ArrayXd& durations = out.geometry_->duration_h;
  const double window_h = median({durations.begin(), durations.end()});
  const double run_h = (out.geometry_->start_h + durations).maxCoeff();
  const double rows = static_cast<double>(out.rows_);
  const double least_b = 1.0 / std::sqrt(rows * window_h);
  const double most_b = kMostFlickerPerWindow / std::sqrt(window_h);
  const double least_k = kLeastWalkPerRun / run_h;
  const double most_k = std::max(kMostWalkPerRow * rows, 10.0 * kLeastWalkPerRun) / run_h;
  out.step_of_b_ = std::pow(most_b / least_b, 1.0 / (kFlickerShapes - 1));
  out.step_of_k_ = std::pow(most_k / least_k, 1.0 / (kWalkShapes - 1));
  for (int b = 0; b <= kFlickerShapes; ++b) {
    for (int k = 0; k <= kWalkShapes; ++k) {
      out.shapes_.push_back(
          {.angle_random_walk_deg_per_sqrt_h = 1.0,
           .bias_instability_deg_per_h = b == 0 ? 0.0 : least_b * std::pow(out.step_of_b_, b - 1),
           .rate_random_walk_deg_per_h_per_sqrt_h =
               k == 0 ? 0.0 : least_k * std::pow(out.step_of_k_, k - 1)});
      out.log_prior_.push_back(kPriorPowerOfWalk * std::max(k - 1, 0) * std::log(out.step_of_k_));
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
