#pragma once
// Gyro noise for the tests of model/, written apart from the code under test: samples at a
// constant step, from which the tests make their averaging windows by adding up.

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "model/noise/noise.hpp"
#include "model/noise/noise_prior.hpp"

namespace fogbench::model {

class NoiseGenerator {
 public:
  /// Flicker from a ladder of ratio 2, from a tenth of the step to 30 times the record.
  NoiseGenerator(const NoiseCoefficients& noise, double step_s, double record_s, unsigned seed)
      : noise_(noise), step_s_(step_s), random_(seed) {
    const double sigma =
        noise.bias_instability_deg_per_h * std::sqrt(std::log(2.0) / std::numbers::pi);
    for (double tau = step_s / 10.0; tau < 30.0 * record_s; tau *= 2.0) {
      terms_.push_back({.tau_s = tau, .sigma = sigma, .state = sigma * normal()});
    }
  }

  /// Mean rate over the next step, deg/h.
  double next() {
    const double hours = step_s_ / 3600.0;
    double rate = noise_.angle_random_walk_deg_per_sqrt_h / std::sqrt(hours) * normal();
    for (Term& term : terms_) rate += advance(term);
    const double k = noise_.rate_random_walk_deg_per_h_per_sqrt_h * std::sqrt(hours);
    const double n1 = normal(), n2 = normal();
    rate += walk_ + k * (0.5 * n1 + n2 / (2.0 * std::sqrt(3.0)));
    walk_ += k * n1;
    const double angle = quantisation_angle();
    rate += (angle - last_angle_) / hours;
    last_angle_ = angle;
    return rate;
  }

  double mean_of(int steps) {
    double sum = 0.0;
    for (int i = 0; i < steps; ++i) sum += next();
    return sum / steps;
  }

  double normal() { return normal_(random_); }

 private:
  struct Term {
    double tau_s, sigma, state;
  };

  /// Draws (mean over the step, state at its end) given the state at its start.
  double advance(Term& term) {
    const double x = step_s_ / term.tau_s;
    const double keep = std::exp(-x);
    const double phi = (1.0 - keep) / x;
    const double end_variance = 1.0 - keep * keep;
    const double cross = phi * (1.0 - keep);
    const double mean_variance = std::max(0.0, 2.0 * (x - 1.0 + keep) / (x * x) - phi * phi);
    const double n1 = normal(), n2 = normal();
    const double along = cross / std::sqrt(end_variance);
    const double rest = std::sqrt(std::max(0.0, mean_variance - along * along));
    const double mean = phi * term.state + term.sigma * (along * n1 + rest * n2);
    term.state = keep * term.state + term.sigma * std::sqrt(end_variance) * n1;
    return mean;
  }

  /// White angle noise of the stated size.
  double quantisation_angle() {
    return noise_.quantisation_deg == 0.0 ? 0.0 : noise_.quantisation_deg * normal();
  }

  NoiseCoefficients noise_;
  double step_s_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::vector<Term> terms_;
  double walk_ = 0.0;
  double last_angle_ = 0.0;
};

inline constexpr NoiseCoefficients kNavigation{0.001, 0.003, 0.003, 0.0};
inline constexpr NoiseCoefficients kTactical{0.005, 0.02, 0.02, 0.0};

/// The noise of an instrument whose ratios B/N and K/N are drawn from the prior itself.
inline NoiseCoefficients drawn_instrument(double angle_random_walk_deg_per_sqrt_h, unsigned seed) {
  std::mt19937_64 random(1'000'000 + seed);  // apart from the noise's own
  std::uniform_real_distribution<double> uniform;
  const auto drawn = [&](const NoisePrior::Ratio& prior) {
    const double below = std::log(uniform(random)) + prior.log_below(prior.most());
    double low = -8.0, high = std::log10(prior.most());
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (prior.log_below(std::pow(10.0, middle)) < below ? low : high) = middle;
    }
    return std::pow(10.0, low);
  };
  const NoisePrior prior;
  const double n = angle_random_walk_deg_per_sqrt_h;
  const double b = n * drawn(prior.b_over_n);
  return {n, b, n * drawn(prior.k_over_n), 0.0};
}

using NoiseOfSeed = std::function<NoiseCoefficients(unsigned seed)>;

inline NoiseOfSeed always(const NoiseCoefficients& noise) {
  return [noise](unsigned) { return noise; };
}

/// `rows` windows of `duration_s` every `period_s`, in one run.
inline Windows regular_windows(int rows, double duration_s, double period_s) {
  Windows w;
  w.run_begin = {0, static_cast<std::size_t>(rows)};
  w.centre_s =
      Eigen::VectorXd::LinSpaced(rows, 0.5 * duration_s, 0.5 * duration_s + (rows - 1) * period_s);
  w.duration_s = Eigen::VectorXd::Constant(rows, duration_s);
  w.white_floor = Eigen::VectorXd::Zero(rows);
  return w;
}

}  // namespace fogbench::model
