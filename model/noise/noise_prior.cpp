#include "model/noise/noise_prior.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "model/noise/noise.hpp"

namespace fogbench::model {
namespace {

// A unit against its data sheet: a factor of 2.
constexpr double kDecadesOfDataSheet = 0.3;
// However long a static record is, another day differs from it by this much at least.
constexpr double kLeastDecades = 0.1;
// The white noise of a static record bounds that of a table from below with this reserve.
constexpr double kReserve = 0.9;
constexpr double kLeastProbability = 1e-300;
// Units differ upwards by more than downwards (heat, vibration, age). A symmetric prior believed a
// walk of K/N = 10 per h too small, and took it for an effect in 4 of 25 tables.
constexpr double kUpwards = 2.0;

/// Mean and spread of a ratio over the plausible noise models. A ratio of zero says that it is too
/// small to show: as the prior has it there.
NoisePrior::Ratio ratio_of(const NoiseEstimate& estimate, double config::NoiseCoefficients::*part,
                           const NoisePrior::Ratio& before) {
  double smallest = before.median * std::pow(10.0, -2.0 * before.decades);
  double total = 0.0, mean = 0.0, square = 0.0;
  for (const auto& [noise, weight] : estimate.plausible) {
    const double ratio = noise.*part / noise.angle_random_walk_deg_per_sqrt_h;
    const double decades = std::log10(std::max(ratio, smallest));
    total += weight;
    mean += weight * decades;
    square += weight * decades * decades;
  }
  if (!(total > 0.0)) return before;
  mean /= total;
  const double spread = std::sqrt(std::max(0.0, square / total - mean * mean));
  return {std::pow(10.0, mean), std::clamp(spread, kLeastDecades, before.decades)};
}

}  // namespace

double NoisePrior::Ratio::log_below(double value) const {
  const double away = std::log10(value / median);
  const double z = away / (away < 0.0 ? decades : kUpwards * decades);
  const double normal = 0.5 * std::erfc(-z / std::numbers::sqrt2);
  const double below = away < 0.0 ? 2.0 * normal : 1.0 + kUpwards * (2.0 * normal - 1.0);
  return std::log(std::max(below / (1.0 + kUpwards), kLeastProbability));
}

double NoisePrior::Ratio::log_density(double value) const {
  const double away = std::log10(value / median);
  const double z = away / (away < 0.0 ? decades : kUpwards * decades);
  return -0.5 * z * z - std::log(std::sqrt(2.0 * std::numbers::pi) * 0.5 * (1.0 + kUpwards) *
                                 decades * std::numbers::ln10);
}

double NoisePrior::Ratio::usual_most() const {
  constexpr double kNineOfTen = 1.2816;
  return median * std::pow(10.0, kNineOfTen * decades);
}

double NoisePrior::walk_is_noise(const NoiseEstimate& estimate) const {
  double within = 0.0, total = 0.0;
  for (const auto& [noise, weight] : estimate.plausible) {
    const double ratio =
        noise.rate_random_walk_deg_per_h_per_sqrt_h / noise.angle_random_walk_deg_per_sqrt_h;
    total += weight;
    within += ratio < k_over_n.finding() ? weight : 0.0;
  }
  return total > 0.0 ? within / total : 1.0;
}

Result<NoisePrior> NoisePrior::stated(const config::NoiseCoefficients& noise) {
  const double n = noise.angle_random_walk_deg_per_sqrt_h;
  const double b = noise.bias_instability_deg_per_h;
  const double k = noise.rate_random_walk_deg_per_h_per_sqrt_h;
  if (!(n > 0.0) || !(b >= 0.0) || !(k >= 0.0) || !std::isfinite(n + b + k)) {
    return Error{ErrorCode::kBadInput,
                 "noise: expected N in deg/sqrt(h) above zero, B in deg/h and K in "
                 "deg/h/sqrt(h) of at least zero"};
  }
  NoisePrior out;
  if (b > 0.0) out.b_over_n = {b / n, kDecadesOfDataSheet};
  if (k > 0.0) out.k_over_n = {k / n, kDecadesOfDataSheet};
  out.least_white = n;
  out.source = Source::kGiven;
  return out;
}

NoisePrior NoisePrior::recorded(const NoiseEstimate& estimate) {
  NoisePrior out;
  out.b_over_n =
      ratio_of(estimate, &config::NoiseCoefficients::bias_instability_deg_per_h, out.b_over_n);
  out.k_over_n = ratio_of(
      estimate, &config::NoiseCoefficients::rate_random_walk_deg_per_h_per_sqrt_h, out.k_over_n);
  out.least_white = kReserve * estimate.noise.angle_random_walk_deg_per_sqrt_h;
  out.source = Source::kStaticRecord;
  return out;
}

}  // namespace fogbench::model
