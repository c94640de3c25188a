#include "model/noise/stated_errors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "tests/model/noise_generator.hpp"

namespace fogbench::model {
namespace {

Windows stating(int rows, const std::function<double(int)>& error) {
  Windows windows = regular_windows(rows, 180.0, 200.0);
  for (int i = 0; i < rows; ++i) windows.white_floor[i] = error(i);
  return windows;
}

TEST(StatedErrors, GiveOneWhiteNoise) {
  EXPECT_NEAR(stated_white(stating(40, [](int) { return 0.01; })), 0.01 * std::sqrt(0.05), 1e-12);
  EXPECT_EQ(stated_white(stating(40, [](int) { return 0.0; })), 0.0);
}

TEST(StatedErrors, ThatAreLargerOnAFifthOfTheRowsAreBelieved) {
  const Windows windows = stating(60, [](int i) { return i % 5 == 2 ? 0.05 : 0.01; });
  const Eigen::VectorXd scale = stated_white_scale(windows);
  EXPECT_NEAR(scale[2], 25.0, 1.0);
  EXPECT_NEAR(scale[3], 1.0, 1e-9);
}

TEST(StatedErrors, ThatGrowAlongTheRunAreBelieved) {
  const Windows windows = stating(60, [](int i) { return 0.01 * std::exp(0.03 * i); });
  const Eigen::VectorXd scale = stated_white_scale(windows);
  EXPECT_NEAR(std::log(scale[59] / scale[0]), 2.0 * 0.03 * 59, 0.3);
}

// Of eleven samples each: the scatter of such errors says nothing of their rows.
TEST(StatedErrors, ThatOnlyScatterAreTakenForOne) {
  std::mt19937_64 engine(3);
  std::chi_squared_distribution<> chi2(10.0);
  const Windows windows = stating(200, [&](int) { return 0.01 * std::sqrt(chi2(engine) / 10.0); });
  const Eigen::VectorXd scale = stated_white_scale(windows);
  EXPECT_LT(scale.array().log().abs().maxCoeff(), 0.5);
}

TEST(StatedErrors, LeaveRowsWithoutOneAtTheUsual) {
  const Windows windows = stating(60, [](int i) { return i == 7 ? 0.0 : i < 30 ? 0.01 : 0.03; });
  EXPECT_EQ(stated_white_scale(windows)[7], 1.0);
  EXPECT_TRUE((stated_white_scale(stating(60, [](int) { return 0.0; })).array() == 1.0).all());
}

}  // namespace
}  // namespace fogbench::model
