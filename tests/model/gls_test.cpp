#include "model/fit/gls.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "tests/model/noise_generator.hpp"

namespace fogbench::model {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd bias_and_slope(const Windows& windows) {
  MatrixXd x(windows.rows(), 2);
  x.col(0).setOnes();
  x.col(1) = VectorXd::LinSpaced(windows.rows(), -1.0, 1.0);
  return x;
}

VectorXd draw(const Windows& windows, const NoiseCoefficients& noise, unsigned seed) {
  NoiseGenerator generator(noise, windows.duration_s[0], windows.centre_s.tail(1)[0], seed);
  VectorXd y(windows.rows());
  for (double& value : y) value = generator.next();
  return y;
}

TEST(Gls, RecoversTheNoiseOfALongRecord) {
  Windows windows = regular_windows(3000, 60.0, 60.0);
  const NoiseCoefficients truth{0.005, 0.02, 0.02, 0.0};
  const auto result = gls(windows, MatrixXd::Ones(3000, 1), draw(windows, truth, 11));
  ASSERT_TRUE(result) << result.error().message;
  const NoiseCoefficients& found = result->noise.noise;
  EXPECT_NEAR(found.angle_random_walk_deg_per_sqrt_h, 0.005, 0.0005);
  EXPECT_NEAR(found.bias_instability_deg_per_h, 0.02, 0.006);
  EXPECT_NEAR(found.rate_random_walk_deg_per_h_per_sqrt_h, 0.02, 0.01);
  EXPECT_THAT(result->noise.says, testing::HasSubstr("bias instability B = 0.0"));
  EXPECT_NEAR(result->whitened.squaredNorm() / 3000.0, 1.0, 0.1);
}

TEST(Gls, EqualsOrdinaryLeastSquaresWhenTheNoiseIsWhite) {
  Windows windows = regular_windows(8, 60.0, 60.0);
  const MatrixXd x = bias_and_slope(windows);
  VectorXd y(8);
  y << 1, 3, 2, 5, 4, 6, 8, 7;
  const auto result = gls(windows, x, y);
  ASSERT_TRUE(result);
  const VectorXd beta = (x.transpose() * x).ldlt().solve(x.transpose() * y);
  const double s2 = (y - x * beta).squaredNorm() / 6.0;
  EXPECT_TRUE(result->beta.isApprox(beta, 1e-12));
  EXPECT_TRUE(result->covariance.isApprox(s2 * (x.transpose() * x).inverse(), 1e-10));
  EXPECT_NEAR(result->coverage_factor, 2.516, 1e-3);  // Student's t, 6 degrees, 95.45 %
  EXPECT_THAT(result->noise.says, testing::HasSubstr("the noise is taken as white"));
}

TEST(Gls, TakesTheWhiteNoiseFromTheStatedErrors) {
  Windows windows = regular_windows(75, 180.0, 200.0);
  windows.white_floor.setConstant(0.001 / std::sqrt(0.05));
  windows.white_floor[3] = 1.0;  // one void row must not spoil the anchor
  const auto result = gls(windows, bias_and_slope(windows), VectorXd::Zero(75));
  ASSERT_TRUE(result);
  EXPECT_TRUE(result->noise.anchored);
  EXPECT_NEAR(result->noise.noise.angle_random_walk_deg_per_sqrt_h, 0.001, 1e-12);
}

TEST(Gls, SurvivesAPerfectFitAndAConstant) {
  Windows windows = regular_windows(40, 180.0, 200.0);
  const MatrixXd x = bias_and_slope(windows);
  for (const VectorXd& y : {VectorXd(x * Eigen::Vector2d(3.0, -2.0)),
                            VectorXd(VectorXd::Constant(40, 1e6)), VectorXd(VectorXd::Zero(40))}) {
    const auto result = gls(windows, x, y);
    ASSERT_TRUE(result);
    EXPECT_TRUE(result->covariance.allFinite());
    EXPECT_TRUE(result->whitened.allFinite());
    EXPECT_LT((y - x * result->beta).norm(), 1e-9 * (1.0 + y.norm()));
  }
}

// As cos and sin at two azimuths beside a bias: the later one gives way, however long it is, so
// that the earlier coefficients keep their meaning.
TEST(Gls, OfDependentColumnsTheEarlierOnesAreDetermined) {
  const Windows windows = regular_windows(60, 60.0, 60.0);
  MatrixXd x = MatrixXd::Zero(60, 3);
  x.col(0).setConstant(0.1);
  x.col(1).head(40).setOnes();
  x.col(2).tail(20).setConstant(5.0);
  const VectorXd y = 7.0 * x.col(0) + 0.05 * x.col(1) + draw(windows, {0.001, 0.0, 0.0, 0.0}, 3);
  const auto result = gls(windows, x, y);
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_NEAR(result->beta[0], 7.0, 0.1);
  EXPECT_NEAR(result->beta[1], 0.05, 0.01);
  EXPECT_TRUE(std::isnan(result->covariance(2, 2)));
}

TEST(Gls, LeavesDependentColumnsUndetermined) {
  Windows windows = regular_windows(40, 180.0, 200.0);
  MatrixXd x(40, 3);
  x.leftCols(2) = bias_and_slope(windows);
  x.col(2) = 2.0 * x.col(1);
  const auto result = gls(windows, x, draw(windows, kNavigation, 5));
  ASSERT_TRUE(result);
  EXPECT_TRUE(std::isfinite(result->covariance(0, 0)));
  EXPECT_EQ(std::isnan(result->covariance(1, 1)) + std::isnan(result->covariance(2, 2)), 1);
}

TEST(Gls, WeightsOfPlausibleNoiseSumToOne) {
  Windows windows = regular_windows(75, 180.0, 200.0);
  const auto estimate =
      estimate_noise(windows, bias_and_slope(windows), draw(windows, kTactical, 6));
  ASSERT_TRUE(estimate);
  double sum = 0.0;
  for (const auto& [noise, weight] : estimate->plausible) sum += weight;
  EXPECT_NEAR(sum, 1.0, 1e-12);
  EXPECT_GT(estimate->plausible.size(), 3u);
}

TEST(Gls, RefusesTooFewRowsAndBadNumbers) {
  Windows windows = regular_windows(2, 60.0, 60.0);
  const MatrixXd x = bias_and_slope(windows);
  auto result = gls(windows, x, VectorXd::Zero(2));
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().message, testing::HasSubstr("2 rows for 2 terms"));
  result = gls(windows, x.topRows(1), VectorXd::Zero(1));
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().message, testing::HasSubstr("as many of each were expected"));
  windows = regular_windows(3, 60.0, 60.0);
  result = gls(windows, MatrixXd::Ones(3, 1), VectorXd::Constant(3, std::nan("")));
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().message, testing::HasSubstr("not a number"));
  EXPECT_FALSE(estimate_noise(windows, MatrixXd::Ones(3, 3), VectorXd::Zero(3)));
}

}  // namespace
}  // namespace fogbench::model
