// The noise against its theory. Seeds are fixed, so a pass stays a pass; bounds are stated in
// standard errors of the estimate, 5 unless said otherwise (one in 1.7 million by chance).

#include "simulator/noise_generator.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

namespace fogbench::simulator {
namespace {

constexpr config::NoiseCoefficients kWhite{.angle_random_walk_deg_per_sqrt_h = 0.001};
constexpr config::NoiseCoefficients kFlicker{.bias_instability_deg_per_h = 0.003};
constexpr config::NoiseCoefficients kWalk{.rate_random_walk_deg_per_h_per_sqrt_h = 0.02};
constexpr config::NoiseCoefficients kTactical{.angle_random_walk_deg_per_sqrt_h = 0.005,
                                              .bias_instability_deg_per_h = 0.02,
                                              .rate_random_walk_deg_per_h_per_sqrt_h = 0.02};

std::vector<double> generate(NoiseGenerator& generator, std::size_t count) {
  std::vector<double> samples(count);
  for (double& sample : samples) sample = generator.next();
  return samples;
}

std::vector<double> bin_means(const std::vector<double>& samples, std::size_t m) {
  std::vector<double> means(samples.size() / m, 0.0);
  for (std::size_t i = 0; i < means.size() * m; ++i) means[i / m] += samples[i];
  for (double& mean : means) mean /= static_cast<double>(m);
  return means;
}

/// Allan variance from adjacent bins of m samples.
double allan_variance(const std::vector<double>& samples, std::size_t m) {
  const std::vector<double> means = bin_means(samples, m);
  double sum = 0.0;
  for (std::size_t i = 1; i < means.size(); ++i) sum += std::pow(means[i] - means[i - 1], 2);
  return sum / (2.0 * static_cast<double>(means.size() - 1));
}

/// Relative standard error of the Allan variance from n bins, not below that of white noise
/// (Lesage and Audoin 1973: sqrt((3n - 4)/(n - 1)^2)), which is the largest of the kinds here.
double allan_error(std::size_t n) {
  const auto bins = static_cast<double>(n);
  return std::sqrt(3.0 * bins - 4.0) / (bins - 1.0);
}

/// Allan variance that the sum of Ornstein-Uhlenbeck processes has by theory.
double flicker_allan_variance(double b, double interval_s, double tau_s) {
  const double variance = b * b * std::log(NoiseGenerator::kRatio) / std::numbers::pi;
  double sum = 0.0;
  for (double tau = NoiseGenerator::kShortestTau * interval_s;; tau *= NoiseGenerator::kRatio) {
    const double e = tau_s / tau;
    // For small e the closed form loses its digits, and the first term of its series is enough.
    sum += e < 1e-4
               ? variance * 2.0 / 3.0 * e
               : variance / (e * e) * (2.0 * e - 3.0 + 4.0 * std::exp(-e) - std::exp(-2.0 * e));
    if (tau >= NoiseGenerator::kLongestTauS) return sum;
  }
}

TEST(NoiseGenerator, WhiteNoiseHasTheAllanDeviationOfTheAngleRandomWalk) {
  for (const double interval_s : {0.001, 0.01, 1.0}) {
    NoiseGenerator generator(kWhite, interval_s, 11);
    const std::vector<double> samples = generate(generator, 400000);
    for (const std::size_t m : {1U, 10U, 100U}) {
      const double tau_h = static_cast<double>(m) * interval_s / 3600.0;
      const double expected = 1e-6 / tau_h;
      EXPECT_NEAR(allan_variance(samples, m) / expected, 1.0, 5.0 * allan_error(400000 / m));
    }
  }
}

TEST(NoiseGenerator, FlickerNoiseIsFlatAtTheBiasInstability) {
  // By theory, the finite sum of processes is flat to a few per cent...
  for (const double tau_s : {0.1, 1.0, 10.0, 100.0, 1000.0}) {
    EXPECT_NEAR(std::sqrt(flicker_allan_variance(0.003, 0.01, tau_s)) / 0.003,
                std::sqrt(2.0 * std::numbers::ln2 / std::numbers::pi), 0.02)
        << tau_s;
  }
  // ...and the samples have that theory's deviation.
  NoiseGenerator generator(kFlicker, 0.01, 5);
  const std::vector<double> samples = generate(generator, 1000000);
  for (const std::size_t m : {1U, 10U, 100U, 1000U}) {
    const double expected = flicker_allan_variance(0.003, 0.01, 0.01 * static_cast<double>(m));
    EXPECT_NEAR(allan_variance(samples, m) / expected, 1.0, 5.0 * allan_error(1000000 / m)) << m;
  }
}

TEST(NoiseGenerator, RateRandomWalkHasItsAllanDeviation) {
  NoiseGenerator generator(kWalk, 1.0, 2);
  const std::vector<double> samples = generate(generator, 400000);
  for (const std::size_t m : {1U, 10U, 100U}) {
    const double tau_h = static_cast<double>(m) / 3600.0;
    const double expected = 4e-4 * tau_h / 3.0;
    EXPECT_NEAR(allan_variance(samples, m) / expected, 1.0, 5.0 * allan_error(400000 / m)) << m;
  }
}

/// Exact covariance of the samples `at`, followed bin by bin, without any block.
Eigen::MatrixXd analytic_covariance(const config::NoiseCoefficients& noise, double interval_s,
                                    const std::vector<std::size_t>& at) {
  const NoiseGenerator generator(noise, interval_s, 1);
  const auto n = static_cast<Eigen::Index>(at.size());
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double white = noise.angle_random_walk_deg_per_sqrt_h;
    covariance(i, i) += white * white * 3600.0 / interval_s;
    for (const BinProcess& p : generator.processes()) {
      double state = p.start_variance;
      for (std::size_t k = 0; k < at[static_cast<std::size_t>(i)]; ++k) {
        state = p.decay * p.decay * state + p.end_variance;
      }
      covariance(i, i) += p.mean_gain * p.mean_gain * state + p.mean_variance;
      double with_state = p.mean_gain * p.decay * state + p.end_mean_covariance;
      std::size_t bin = at[static_cast<std::size_t>(i)] + 1;
      for (Eigen::Index j = i + 1; j < n; ++j) {
        for (; bin < at[static_cast<std::size_t>(j)]; ++bin) with_state *= p.decay;
        covariance(i, j) += p.mean_gain * with_state;
        covariance(j, i) = covariance(i, j);
      }
    }
  }
  return covariance;
}

TEST(NoiseGenerator, CovarianceWithinAndAcrossBlocksIsTheAnalyticOne) {
  // Samples around the first two block boundaries. A long interval makes the random walk count.
  constexpr double kIntervalS = 100.0;
  constexpr int kStreams = 15000;
  const std::vector<std::size_t> at = {0, 30, 31, 32, 33, 63, 64, 95};
  const auto n = static_cast<Eigen::Index>(at.size());
  const Eigen::MatrixXd expected = analytic_covariance(kTactical, kIntervalS, at);
  Eigen::MatrixXd found = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd y(n);
  for (std::uint64_t stream = 0; stream < kStreams; ++stream) {
    NoiseGenerator generator(kTactical, kIntervalS, derive_seed(99, stream));
    const std::vector<double> samples = generate(generator, 96);
    for (Eigen::Index i = 0; i < n; ++i) y(i) = samples[at[static_cast<std::size_t>(i)]];
    found += y * y.transpose() / kStreams;
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      // Of a sample covariance: sqrt((c_ii c_jj + c_ij^2)/streams).
      const double error =
          std::sqrt((expected(i, i) * expected(j, j) + expected(i, j) * expected(i, j)) / kStreams);
      EXPECT_NEAR(found(i, j), expected(i, j), 5.0 * error)
          << at[static_cast<std::size_t>(i)] << ", " << at[static_cast<std::size_t>(j)];
    }
  }
}

TEST(NoiseGenerator, AveragedFastSamplesAreDistributedAsSlowOnes) {
  // By theory, 1 kHz averaged to 1 Hz against 1 Hz drawn directly: the flicker's correlation times
  // are others, its law at 1 s is the same to a few per cent of itself.
  std::vector<std::size_t> at(2000);
  std::iota(at.begin(), at.end(), std::size_t{0});
  const auto difference_variance = [&](const config::NoiseCoefficients& noise) {
    const auto fast = analytic_covariance(noise, 0.001, at);
    return fast.topLeftCorner(1000, 1000).mean() - fast.topRightCorner(1000, 1000).mean();
  };
  const auto slow_difference_variance = [](const config::NoiseCoefficients& noise) {
    const auto slow = analytic_covariance(noise, 1.0, {0, 1});
    return slow(0, 0) - slow(0, 1);
  };
  EXPECT_NEAR(difference_variance(kWhite) / slow_difference_variance(kWhite), 1.0, 1e-9);
  EXPECT_NEAR(difference_variance(kFlicker) / slow_difference_variance(kFlicker), 1.0, 0.02);

  // And the samples themselves have that variance of neighbours' differences.
  NoiseGenerator generator(kTactical, 0.001, 21);
  const std::vector<double> samples = generate(generator, 4000000);
  EXPECT_NEAR(allan_variance(samples, 1000) / difference_variance(kTactical), 1.0,
              5.0 * allan_error(4000));
}

TEST(NoiseGenerator, TheExactLawOfATinyStepHasNoRoundingNoise) {
  // For e = bin/tau << 1 the bin mean's own variance is (2/3) e, which the closed form loses.
  for (const double e : {1e-9, 1e-6, 1e-3, 0.1, 0.49}) {
    const BinProcess p = ornstein_uhlenbeck(1.0, 1.0 / e, 1.0);
    EXPECT_NEAR(p.mean_variance / (2.0 / 3.0 * e), 1.0, 0.76 * e + 1e-9);
    EXPECT_GT(p.end_variance * p.mean_variance, p.end_mean_covariance * p.end_mean_covariance);
  }
  const BinProcess below = ornstein_uhlenbeck(1.0, 1.0, 0.5 - 1e-12);
  const BinProcess above = ornstein_uhlenbeck(1.0, 1.0, 0.5 + 1e-12);
  EXPECT_NEAR(below.mean_variance, above.mean_variance, 1e-11);
}

TEST(NoiseGenerator, WithoutNoiseItIsSilentAndWithOneSeedItRepeats) {
  NoiseGenerator silent({}, 0.01, 1);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(silent.next(), 0.0);
  NoiseGenerator first(kTactical, 0.01, 8);
  NoiseGenerator second(kTactical, 0.01, 8);
  NoiseGenerator other(kTactical, 0.01, 9);
  const std::vector<double> samples = generate(first, 1000);
  EXPECT_EQ(samples, generate(second, 1000));
  EXPECT_NE(samples, generate(other, 1000));
}

TEST(AngleQuantiser, ItsErrorIsTheDifferenceOfAQuantisedAngle) {
  constexpr double kQ = 1e-6;
  constexpr double kIntervalS = 0.01;
  AngleQuantiser quantiser(kQ, kIntervalS);
  NoiseGenerator white(kWhite, kIntervalS, 3);
  std::vector<double> error(400000);
  double angle_error = 0.0;
  const double increment = std::sqrt(12.0) * kQ;
  for (double& e : error) {
    const double rate = 12.4 + white.next();
    e = quantiser.quantise(rate) - rate;
    angle_error += e * kIntervalS / 3600.0;
    ASSERT_LE(std::abs(angle_error), 0.5001 * increment);
  }
  for (const std::size_t m : {1U, 4U, 16U}) {
    const double tau_h = static_cast<double>(m) * kIntervalS / 3600.0;
    const double expected = 3.0 * kQ * kQ / (tau_h * tau_h);
    EXPECT_NEAR(allan_variance(error, m) / expected, 1.0, 0.03) << m;
  }
}

TEST(AngleQuantiser, LeavesTheRateAloneWithoutAnIncrement) {
  AngleQuantiser quantiser(0.0, 0.01);
  EXPECT_EQ(quantiser.quantise(1.2345), 1.2345);
}

}  // namespace
}  // namespace fogbench::simulator
