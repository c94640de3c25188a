#include "simulator/noise_generator.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "config/units.hpp"

namespace fogbench::simulator {
namespace {

/// 2 e - 3 + 4 exp(-e) - exp(-2 e), of order (2/3) e^3: by its power series where the closed form
/// loses all digits.
double mean_variance_factor(double e) {
  if (e > 0.5) return 2.0 * e - 3.0 + 4.0 * std::exp(-e) - std::exp(-2.0 * e);
  double sum = 0.0;
  double power = -e;  // (-e)^n / n!
  double two_to_n = 2.0;
  for (int n = 2; n <= 24; ++n) {
    power *= -e / n;
    two_to_n *= 2.0;
    sum += power * (4.0 - two_to_n);
  }
  return sum;
}

BinProcess random_walk(double variance_per_bin) {
  return {.decay = 1.0,
          .mean_gain = 1.0,
          .end_variance = variance_per_bin,
          .end_mean_covariance = variance_per_bin / 2.0,
          .mean_variance = variance_per_bin / 3.0,
          .start_variance = 0.0};
}

std::vector<BinProcess> make_processes(const config::NoiseCoefficients& noise, double interval_s) {
  std::vector<BinProcess> processes;
  const double b = noise.bias_instability_deg_per_h;
  if (b > 0.0) {
    const double variance = b * b * std::log(NoiseGenerator::kRatio) / std::numbers::pi;
    for (double tau = NoiseGenerator::kShortestTau * interval_s;; tau *= NoiseGenerator::kRatio) {
      processes.push_back(ornstein_uhlenbeck(variance, tau, interval_s));
      if (tau >= NoiseGenerator::kLongestTauS) break;
    }
  }
  const double k = noise.rate_random_walk_deg_per_h_per_sqrt_h;
  if (k > 0.0) processes.push_back(random_walk(k * k * interval_s / config::kSecondsPerHour));
  return processes;
}

}  // namespace

BinProcess ornstein_uhlenbeck(double variance, double tau, double bin) {
  const double e = bin / tau;
  const double one_minus_decay = -std::expm1(-e);
  return {.decay = std::exp(-e),
          .mean_gain = one_minus_decay / e,
          .end_variance = -variance * std::expm1(-2.0 * e),
          .end_mean_covariance = variance * one_minus_decay * one_minus_decay / e,
          .mean_variance = variance * mean_variance_factor(e) / (e * e),
          .start_variance = variance};
}

NoiseGenerator::NoiseGenerator(const config::NoiseCoefficients& noise, double interval_s,
                               std::uint64_t seed)
    : normal_(seed), processes_(make_processes(noise, interval_s)) {
  constexpr auto m = static_cast<Eigen::Index>(kBlock);
  const auto states = static_cast<Eigen::Index>(processes_.size());
  const Eigen::Index rows = m + states;
  const double n = noise.angle_random_walk_deg_per_sqrt_h;

  Eigen::MatrixXd response = Eigen::MatrixXd::Zero(rows, states);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(rows, rows);
  covariance.topLeftCorner(m, m).diagonal().setConstant(n * n * config::kSecondsPerHour /
                                                        interval_s);
  for (Eigen::Index j = 0; j < states; ++j) {
    const BinProcess& p = processes_[static_cast<std::size_t>(j)];
    double decay_to_bin = 1.0;    // decay^i
    double state_variance = 0.0;  // of the state at bin i's start, given the block's start
    for (Eigen::Index i = 0; i < m; ++i) {
      response(i, j) = p.mean_gain * decay_to_bin;
      covariance(i, i) += p.mean_gain * p.mean_gain * state_variance + p.mean_variance;
      // With the state at the bin's end; every later bin sees this bin through that state.
      double with_state = p.mean_gain * p.decay * state_variance + p.end_mean_covariance;
      for (Eigen::Index later = i + 1; later < m; ++later) {
        covariance(later, i) += p.mean_gain * with_state;
        with_state *= p.decay;
      }
      covariance(m + j, i) = with_state;
      decay_to_bin *= p.decay;
      state_variance = p.decay * p.decay * state_variance + p.end_variance;
    }
    response(m + j, j) = decay_to_bin;
    covariance(m + j, m + j) = state_variance;
  }

  // Scaled to a unit diagonal: the variances differ by many orders of magnitude. A zero on the
  // diagonal (no noise at all) stays a row of zeros.
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt();
  const Eigen::VectorXd inverse = scale.unaryExpr([](double s) { return s > 0.0 ? 1.0 / s : 0.0; });
  Eigen::MatrixXd correlation = inverse.asDiagonal() * covariance * inverse.asDiagonal();
  correlation.diagonal().setOnes();
  const Eigen::MatrixXd factor = correlation.llt().matrixL();

  gain_.resize(static_cast<std::size_t>(rows * (states + rows)));
  Eigen::Map<Eigen::MatrixXd> gain(gain_.data(), rows, states + rows);
  gain << response, scale.asDiagonal() * factor;
  input_.assign(static_cast<std::size_t>(states + rows), 0.0);
  block_.assign(static_cast<std::size_t>(rows), 0.0);
  for (std::size_t j = 0; j < processes_.size(); ++j) {
    block_[kBlock + j] = std::sqrt(processes_[j].start_variance) * normal_();
  }
}

void NoiseGenerator::draw_block() {
  const auto states = static_cast<std::ptrdiff_t>(processes_.size());
  std::copy(block_.begin() + kBlock, block_.end(), input_.begin());
  std::generate(input_.begin() + states, input_.end(), [this] { return normal_(); });
  const auto rows = static_cast<Eigen::Index>(block_.size());
  const auto columns = static_cast<Eigen::Index>(input_.size());
  Eigen::Map<Eigen::VectorXd>(block_.data(), rows).noalias() =
      Eigen::Map<const Eigen::MatrixXd>(gain_.data(), rows, columns) *
      Eigen::Map<const Eigen::VectorXd>(input_.data(), columns);
  position_ = 0;
}

AngleQuantiser::AngleQuantiser(double quantisation_deg, double interval_s)
    : increment_deg_(std::sqrt(12.0) * quantisation_deg),
      interval_h_(interval_s / config::kSecondsPerHour) {}

double AngleQuantiser::quantise(double rate_deg_per_h) {
  if (increment_deg_ <= 0.0) return rate_deg_per_h;
  angle_ += rate_deg_per_h * interval_h_ / increment_deg_;
  const double counts = std::nearbyint(angle_);
  angle_ -= counts;
  return counts * increment_deg_ / interval_h_;
}

}  // namespace fogbench::simulator
