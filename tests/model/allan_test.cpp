#include "model/noise/allan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "tests/model/noise_generator.hpp"

namespace fogbench::model {
namespace {

double deviation_at(const std::vector<AllanPoint>& curve, double tau_s) {
  for (const AllanPoint& point : curve) {
    if (point.tau_s == tau_s) return point.deviation_deg_per_h;
  }
  return std::nan("");
}

// NBS Monograph 140, annex 8.E, nine frequencies; overlapping deviations of NIST SP 1065, table 30.
TEST(AllanDeviation, ReproducesTheNbsTenPointSet) {
  const std::vector<double> rate{892, 809, 823, 798, 671, 644, 883, 903, 677};
  const auto curve = allan_deviation(rate, 1.0);
  ASSERT_TRUE(curve);
  EXPECT_NEAR(deviation_at(*curve, 1.0), 91.22945, 5e-6);
  EXPECT_NEAR(deviation_at(*curve, 2.0), 85.95287, 5e-6);
}

// NIST SP 1065, section 12.4: 1000 numbers of a prime modulus generator, table 31.
TEST(AllanDeviation, ReproducesTheNistThousandPointSet) {
  std::vector<double> rate;
  std::uint64_t state = 1234567890;
  for (int i = 0; i < 1000; ++i) {
    rate.push_back(static_cast<double>(state) / 2147483647.0);
    state = 16807 * state % 2147483647;
  }
  const auto curve = allan_deviation(rate, 1.0, true);
  ASSERT_TRUE(curve);
  EXPECT_NEAR(deviation_at(*curve, 1.0), 2.922319e-01, 5e-8);
  EXPECT_NEAR(deviation_at(*curve, 10.0), 9.159953e-02, 5e-9);
  EXPECT_NEAR(deviation_at(*curve, 100.0), 3.241343e-02, 5e-9);
  EXPECT_EQ(curve->front().count, 999u);
}

TEST(AllanDeviation, DoesNotSeeAConstantRate) {
  const std::vector<double> rate(1000, 1e6);
  const auto curve = allan_deviation(rate, 0.01);
  ASSERT_TRUE(curve);
  for (const AllanPoint& point : *curve) EXPECT_EQ(point.deviation_deg_per_h, 0.0);
  const auto fit = fit_allan(*curve);
  ASSERT_FALSE(fit);
  EXPECT_THAT(fit.error().message, testing::HasSubstr("0 points of positive Allan deviation"));
}

TEST(AllanDeviation, RefusesWhatItCannotUse) {
  const std::vector<double> two{1.0, 2.0}, bad{1.0, std::nan(""), 2.0}, good{1.0, 2.0, 3.0};
  EXPECT_THAT(allan_deviation(two, 1.0).error().message, testing::HasSubstr("at least 3"));
  EXPECT_THAT(allan_deviation(bad, 1.0).error().message, testing::HasSubstr("sample 2 is nan"));
  EXPECT_THAT(allan_deviation(good, 0.0).error().message, testing::HasSubstr("interval 0 s"));
  EXPECT_TRUE(allan_deviation(good, 1.0));
}

TEST(FitAllan, ReadsTheCoefficientsOfAnExactCurve) {
  const double n = 0.005, b = 0.02, k = 0.02, q = 1e-5;
  std::vector<AllanPoint> curve;
  for (double tau_s = 0.1; tau_s < 1e5; tau_s *= 2.0) {
    const double tau = tau_s / 3600.0;
    const double variance = n * n / tau + 2.0 * std::log(2.0) / M_PI * b * b + k * k * tau / 3.0 +
                            3.0 * q * q / (tau * tau);
    curve.push_back({tau_s, std::sqrt(variance), 0.01 * std::sqrt(variance), 100});
  }
  const auto fit = fit_allan(curve);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->noise.angle_random_walk_deg_per_sqrt_h, n, 1e-9);
  EXPECT_NEAR(fit->noise.bias_instability_deg_per_h, b, 1e-9);
  EXPECT_NEAR(fit->noise.rate_random_walk_deg_per_h_per_sqrt_h, k, 1e-9);
  EXPECT_NEAR(fit->noise.quantisation_deg, q, 1e-12);
}

TEST(FitAllan, HoldsWhatIsAbsentAtZero) {
  NoiseGenerator generator({0.005, 0.0, 0.0, 0.0}, 10.0, 1e5, 1);
  std::vector<double> rate(10000);
  for (double& value : rate) value = generator.next();
  const auto curve = allan_deviation(rate, 10.0);
  ASSERT_TRUE(curve);
  const auto fit = fit_allan(*curve);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->noise.angle_random_walk_deg_per_sqrt_h, 0.005, 0.00015);
  EXPECT_LT(fit->noise.bias_instability_deg_per_h, 0.002);
  EXPECT_LT(fit->noise.rate_random_walk_deg_per_h_per_sqrt_h, 0.004);
}

TEST(FitAllan, StatesTheErrorsThatItsEstimatesScatterBy) {
  const NoiseCoefficients truth{0.005, 0.02, 0.02, 1e-4};
  constexpr int kSeeds = 40, kSamples = 8192;
  double sum[4] = {}, squares[4] = {}, stated[4] = {};
  int held[4] = {};
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    NoiseGenerator generator(truth, 10.0, 10.0 * kSamples, seed);
    std::vector<double> rate(kSamples);
    for (double& value : rate) value = generator.next();
    const auto fit = fit_allan(*allan_deviation(rate, 10.0));
    ASSERT_TRUE(fit);
    const double found[] = {
        fit->noise.angle_random_walk_deg_per_sqrt_h, fit->noise.bias_instability_deg_per_h,
        fit->noise.rate_random_walk_deg_per_h_per_sqrt_h, fit->noise.quantisation_deg};
    const double error[] = {fit->standard_error.angle_random_walk_deg_per_sqrt_h,
                            fit->standard_error.bias_instability_deg_per_h,
                            fit->standard_error.rate_random_walk_deg_per_h_per_sqrt_h,
                            fit->standard_error.quantisation_deg};
    for (int c = 0; c < 4; ++c) {
      if (!(error[c] > 0.0)) continue;
      ++held[c];
      sum[c] += found[c];
      squares[c] += found[c] * found[c];
      stated[c] += error[c];
    }
  }
  const double expected[] = {0.005, 0.02, 0.02, 1e-4};
  for (int c = 0; c < 4; ++c) {
    ASSERT_GT(held[c], kSeeds / 2) << c;
    const double mean = sum[c] / held[c];
    const double scatter = std::sqrt(squares[c] / held[c] - mean * mean);
    EXPECT_NEAR(mean / expected[c], 1.0, 0.15) << c;
    EXPECT_GT(stated[c] / held[c] / scatter, 0.7) << c;
    EXPECT_LT(stated[c] / held[c] / scatter, 1.6) << c;
  }
}

}  // namespace
}  // namespace fogbench::model
