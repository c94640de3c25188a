#include "model/noise/noise_prior.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "model/fit/gls.hpp"
#include "tests/model/noise_generator.hpp"

namespace fogbench::model {
namespace {

using testing::HasSubstr;

TEST(NoisePrior, IsADistribution) {
  const NoisePrior::Ratio ratio{3.0, 0.5};
  EXPECT_NEAR(ratio.log_below(3.0), std::log(1.0 / 3.0), 1e-12) << "wider upwards";
  EXPECT_NEAR(ratio.log_below(1e9), 0.0, 1e-9);
  for (const double value : {2.0, 7.0}) {
    const double step = 1e-4;
    const double mass =
        std::exp(ratio.log_below(value * std::exp(step))) - std::exp(ratio.log_below(value));
    EXPECT_NEAR(std::exp(ratio.log_density(value)), mass / step, 1e-3) << value;
  }
}

TEST(NoisePrior, CallsAWalkTenTimesBeyondTheUsualAFinding) {
  const NoisePrior prior;
  EXPECT_NEAR(prior.k_over_n.usual_most(), 2.5, 0.1);
  EXPECT_NEAR(prior.k_over_n.finding(), 25.0, 1.0);
  NoiseEstimate estimate;
  estimate.plausible = {{{0.001, 0.0, 0.003, 0.0}, 0.25}, {{0.001, 0.0, 0.05, 0.0}, 0.75}};
  EXPECT_NEAR(prior.walk_is_noise(estimate), 0.25, 1e-12);
}

TEST(NoisePrior, OfADataSheetKeepsWhatItDoesNotState) {
  const auto prior = NoisePrior::stated({0.001, 0.004, 0.0, 0.0});
  ASSERT_TRUE(prior) << prior.error().message;
  EXPECT_DOUBLE_EQ(prior->b_over_n.median, 4.0);
  EXPECT_LT(prior->b_over_n.decades, NoisePrior{}.b_over_n.decades);
  EXPECT_DOUBLE_EQ(prior->k_over_n.median, NoisePrior{}.k_over_n.median);
  EXPECT_DOUBLE_EQ(prior->least_white, 0.001);
}

TEST(NoisePrior, RefusesADataSheetWithoutWhiteNoise) {
  EXPECT_THAT(NoisePrior::stated({0.0, 0.004, 0.0, 0.0}).error().message, HasSubstr("above zero"));
  EXPECT_FALSE(NoisePrior::stated({0.001, -1.0, 0.0, 0.0}));
  EXPECT_FALSE(NoisePrior::stated({0.001, 0.0, std::nan(""), 0.0}));
}

Eigen::VectorXd drawn(const Windows& windows, const NoiseCoefficients& noise, unsigned seed) {
  NoiseGenerator generator(noise, windows.duration_s[0], windows.centre_s.tail(1)[0], seed);
  Eigen::VectorXd y(windows.rows());
  for (double& value : y) value = generator.next();
  return y;
}

TEST(NoisePrior, OfAStaticRecordIsAroundItsNoise) {
  const Windows windows = regular_windows(1500, 60.0, 60.0);
  const auto record =
      gls(windows, Eigen::MatrixXd::Ones(1500, 1), drawn(windows, {0.005, 0.02, 0.02, 0.0}, 5));
  ASSERT_TRUE(record);
  const NoisePrior prior = NoisePrior::recorded(record->noise);
  EXPECT_NEAR(std::log10(prior.b_over_n.median), std::log10(4.0), 0.3);
  EXPECT_LT(prior.b_over_n.decades, 0.4);
  EXPECT_NEAR(prior.least_white, 0.0045, 0.0005);
}

// A smooth misfit a thousand times the white noise is no random walk of any gyro.
TEST(NoisePrior, KeepsTheWalkWithinWhatInstrumentsDo) {
  const Windows windows = regular_windows(120, 60.0, 60.0);
  Eigen::VectorXd y = drawn(windows, {0.001, 0.0, 0.0, 0.0}, 7);
  for (Eigen::Index i = 0; i < y.size(); ++i) y[i] += 8.0 * std::sin(0.05 * static_cast<double>(i));
  const auto result = gls(windows, Eigen::MatrixXd::Ones(120, 1), y);
  ASSERT_TRUE(result);
  const NoiseCoefficients& noise = result->noise.noise;
  EXPECT_LE(noise.rate_random_walk_deg_per_h_per_sqrt_h,
            1.001 * NoisePrior{}.k_over_n.most() * noise.angle_random_walk_deg_per_sqrt_h);
}

// The grid of shapes is coarse: an estimate that only ever sat on it would be off by its half step.
TEST(NoisePrior, LeavesTheEstimateFreeBetweenTheGridsShapes) {
  const Windows windows = regular_windows(600, 60.0, 60.0);
  const auto shapes = NoiseShapes::make(windows);
  ASSERT_TRUE(shapes);
  const auto result =
      gls(*shapes, Eigen::MatrixXd::Ones(600, 1), drawn(windows, {0.002, 0.0, 0.02, 0.0}, 9));
  ASSERT_TRUE(result);
  const NoiseCoefficients& noise = result->noise.noise;
  const double ratio =
      noise.rate_random_walk_deg_per_h_per_sqrt_h / noise.angle_random_walk_deg_per_sqrt_h;
  ASSERT_GT(ratio, 0.0);
  bool on_grid = false;
  for (std::size_t i = 0; i < shapes->size(); ++i) {
    const double value = shapes->shape(i).rate_random_walk_deg_per_h_per_sqrt_h;
    on_grid = on_grid || std::abs(value - ratio) < 1e-9 * ratio;
  }
  EXPECT_FALSE(on_grid);
}

}  // namespace
}  // namespace fogbench::model
