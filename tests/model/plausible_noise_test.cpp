#include "model/noise/plausible_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/model/noise_generator.hpp"

namespace fogbench::model {
namespace {

NoiseEstimate certain(const NoiseCoefficients& noise) {
  NoiseEstimate out;
  out.noise = noise;
  out.plausible = {{noise, 1.0}};
  return out;
}

TEST(NoiseFloor, OfWhiteNoiseIsItsSizeLessWhatTheFitTakes) {
  const Windows windows = regular_windows(100, 180.0, 200.0);
  const auto shapes = NoiseShapes::make(windows);
  ASSERT_TRUE(shapes);
  const Eigen::MatrixXd columns = Eigen::MatrixXd::Random(100, 20);
  const NoiseFloor floor = noise_floor(*shapes, certain({0.001, 0.0, 0.0, 0.0}), columns, 100, 1);
  const double expected = 0.001 / std::sqrt(0.05) * std::sqrt(0.8);
  EXPECT_NEAR(floor.white, expected, 1e-9);
  EXPECT_NEAR(floor.median, expected, 0.02 * expected);
  EXPECT_LT(floor.low, floor.median);
  EXPECT_GT(floor.high, floor.median);
}

TEST(NoiseFloor, SaysApartWhatSlowNoiseAdds) {
  const Windows windows = regular_windows(100, 180.0, 200.0);
  const auto shapes = NoiseShapes::make(windows);
  ASSERT_TRUE(shapes);
  const Eigen::MatrixXd bias = Eigen::MatrixXd::Ones(100, 1);
  const NoiseFloor floor = noise_floor(*shapes, certain({0.001, 0.0, 0.01, 0.0}), bias, 100, 1);
  EXPECT_NEAR(floor.white, 0.001 / std::sqrt(0.05), 0.0001);
  EXPECT_GT(floor.median, 1.5 * floor.white);
  EXPECT_GT(floor.high, 2.0 * floor.low) << "a walk wanders far in one record, little in another";
}

TEST(NoiseFloor, IsNeverAboveWhatIsThere) {
  NoiseFloor floor;
  floor.median = 0.01;
  EXPECT_EQ(floor.beside(0.02), 0.01);
  EXPECT_EQ(floor.beside(0.006), 0.006);
  EXPECT_EQ(floor.beside(std::nan("")), 0.01);
}

// Half of the rows five times as noisy: the floor is what such rows leave.
TEST(NoiseFloor, KnowsRowsOfDifferentErrors) {
  Windows windows = regular_windows(100, 180.0, 200.0);
  windows.white_scale = Eigen::VectorXd::Ones(100);
  windows.white_scale.tail(50).setConstant(25.0);
  const auto shapes = NoiseShapes::make(windows);
  ASSERT_TRUE(shapes);
  const NoiseFloor floor =
      noise_floor(*shapes, certain({0.001, 0.0, 0.0, 0.0}), Eigen::MatrixXd(100, 0), 100, 1);
  EXPECT_NEAR(floor.white, 0.001 / std::sqrt(0.05) * std::sqrt(13.0), 1e-6);
  EXPECT_NEAR(floor.median, floor.white, 0.05 * floor.white);
}

}  // namespace
}  // namespace fogbench::model
