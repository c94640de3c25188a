#include "model/noise/noise.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "model/noise/window_geometry.hpp"
#include "tests/model/noise_generator.hpp"

namespace fogbench::model {
namespace {

/// Two runs of unequal windows with gaps from nothing to hours.
Windows uneven_windows() {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  constexpr int kRows = 120;
  Windows w;
  w.run_begin = {0, 50, kRows};
  w.centre_s.resize(kRows);
  w.duration_s.resize(kRows);
  w.white_floor = Eigen::VectorXd::Zero(kRows);
  double end = 100.0;
  for (int i = 0; i < kRows; ++i) {
    if (i == 50) end = 0.0;
    const double gap = i % 3 == 0 ? 0.0 : i % 10 == 1 ? 5000.0 * uniform(random) : 30.0;
    w.duration_s[i] = 10.0 + 300.0 * uniform(random);
    w.centre_s[i] = end + gap + 0.5 * w.duration_s[i];
    end += gap + w.duration_s[i];
  }
  return w;
}

Eigen::MatrixXd some_columns(Eigen::Index rows) {
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, 3, [&] { return normal(random); });
}

class WhitenerOfGrade : public testing::TestWithParam<NoiseCoefficients> {};

TEST_P(WhitenerOfGrade, EqualsTheCholeskyFactorOfTheCovariance) {
  const Windows windows = uneven_windows();
  const auto whitener = make_whitener(windows, GetParam());
  const auto omega = noise_covariance(windows, GetParam());
  ASSERT_TRUE(whitener && omega);
  const Eigen::LLT<Eigen::MatrixXd> llt(*omega);
  ASSERT_EQ(llt.info(), Eigen::Success);
  const Eigen::MatrixXd l = llt.matrixL();
  const Eigen::MatrixXd columns = some_columns(windows.rows());
  const auto relative = [](const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    return (a - b).norm() / b.norm();
  };
  EXPECT_LT(relative((*whitener)->whiten(columns), llt.matrixL().solve(columns)), 1e-9);
  EXPECT_LT(relative((*whitener)->colour(columns), l * columns), 1e-9);
  EXPECT_LT(relative((*whitener)->colour_transposed(columns), l.transpose() * columns), 1e-9);
  EXPECT_LT(relative((*whitener)->standard_deviation(), omega->diagonal().cwiseSqrt()), 1e-12);
  EXPECT_NEAR((*whitener)->log_determinant(), 2.0 * l.diagonal().array().log().sum(), 1e-8);
}

INSTANTIATE_TEST_SUITE_P(Grades, WhitenerOfGrade,
                         testing::Values(kNavigation, kTactical,
                                         NoiseCoefficients{0.001, 0.0, 0.0, 0.0},
                                         NoiseCoefficients{0.0, 0.003, 0.0, 0.0},
                                         NoiseCoefficients{0.0, 0.0, 0.01, 0.0},
                                         NoiseCoefficients{1e-6, 0.3, 3.0, 0.0}));

TEST(NoiseCovariance, IsTheDoubleIntegralOverBothWindows) {
  const Windows windows = uneven_windows();
  const NoiseCoefficients noise{0.0, 1.0, 0.5, 0.0};
  const auto omega = noise_covariance(windows, noise);
  ASSERT_TRUE(omega);
  const FlickerLadder ladder = FlickerLadder::for_windows(windows);
  const double run_start = windows.centre_s[50] - 0.5 * windows.duration_s[50];
  for (const auto& [i, j] : {std::pair{52, 52}, {52, 53}, {51, 70}, {60, 60}}) {
    constexpr int kPoints = 1500;  // midpoint rule over both windows
    double sum = 0.0;
    for (int a = 0; a < kPoints; ++a) {
      const double u = windows.centre_s[i] + windows.duration_s[i] * ((a + 0.5) / kPoints - 0.5);
      for (int b = 0; b < kPoints; ++b) {
        const double v = windows.centre_s[j] + windows.duration_s[j] * ((b + 0.5) / kPoints - 0.5);
        sum += 0.25 * (std::min(u, v) - run_start) / 3600.0;
        for (double tau : ladder.tau_s) {
          sum += ladder.variance_per_b2 * std::exp(-std::abs(u - v) / tau);
        }
      }
    }
    EXPECT_NEAR((*omega)(i, j) / (sum / kPoints / kPoints), 1.0, 1e-5) << i << ' ' << j;
  }
}

TEST(NoiseCovariance, KeepsRunsApart) {
  const auto omega = noise_covariance(uneven_windows(), kNavigation);
  ASSERT_TRUE(omega);
  EXPECT_EQ(omega->topRightCorner(50, 70).cwiseAbs().maxCoeff(), 0.0);
}

TEST(NoiseCovariance, HasTheAllanVarianceOfIeee952) {
  constexpr double kTau = 100.0, kHours = kTau / 3600.0;
  const Windows windows = regular_windows(400, kTau, kTau);
  const auto allan = [&](const NoiseCoefficients& noise, int m) {
    const auto omega = noise_covariance(windows, noise);
    Eigen::VectorXd w = Eigen::VectorXd::Zero(400);  // difference of two means of m windows
    w.segment(150 - m, m).setConstant(-1.0 / m);
    w.segment(150, m).setConstant(1.0 / m);
    return 0.5 * w.dot(*omega * w);
  };
  for (int m : {1, 8, 64}) {
    const double hours = m * kHours;
    EXPECT_NEAR(allan({1.0, 0.0, 0.0, 0.0}, m) * hours, 1.0, 1e-9);
    // Flicker faster than a tenth of a window is left to the white noise.
    EXPECT_NEAR(std::sqrt(allan({0.0, 1.0, 0.0, 0.0}, m)), 0.664, 0.664 * 0.04) << m;
    EXPECT_NEAR(allan({0.0, 0.0, 1.0, 0.0}, m) / (hours / 3.0), 1.0, 1e-6);
  }
}

TEST(DecayIntegrals, AreExactForShortAndLongWindows) {
  // Against the series and the asymptote; the switch of formula lies at 0.02.
  for (double x : {1e-12, 1e-4, 0.0199999, 0.0200001}) {
    EXPECT_NEAR(decay_mean(x), 1.0 - x / 2 + x * x / 6 - x * x * x / 24,
                x * x * x * x / 100 + 1e-15);
    EXPECT_NEAR(decay_double_mean(x), 1.0 - x / 3 + x * x / 12 - x * x * x / 60,
                3e-9 * x * x + 1e-15 + x * x * x * x / 300);
  }
  EXPECT_NEAR(decay_double_mean(0.02 - 1e-12), decay_double_mean(0.02 + 1e-12), 1e-12);
  EXPECT_DOUBLE_EQ(decay_mean(1e6), 1e-6);
  EXPECT_NEAR(decay_double_mean(1e6), 2e-6, 1e-11);
}

TEST(CheckWindows, NamesTheRowsThatOverlap) {
  Windows windows = regular_windows(4, 60.0, 60.0);
  ASSERT_TRUE(check_windows(windows));
  windows.duration_s[2] = 70.0;
  const auto status = check_windows(windows);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kBadInput);
  EXPECT_EQ(status.error().message, "rows 2 and 3: their averaging windows overlap by 5 s");
  EXPECT_FALSE(make_whitener(windows, kNavigation));
  EXPECT_FALSE(noise_covariance(windows, kNavigation));
}

TEST(CheckWindows, RefusesWhatIsNoWindow) {
  const auto message = [](Windows windows) {
    const auto status = check_windows(windows);
    return status ? std::string() : status.error().message;
  };
  Windows windows = regular_windows(3, 60.0, 60.0);
  windows.duration_s[1] = 0.0;
  EXPECT_THAT(message(windows), testing::HasSubstr("row 2: duration_s is 0"));
  windows = regular_windows(3, 60.0, 60.0);
  windows.centre_s[1] = std::nan("");
  EXPECT_THAT(message(windows), testing::HasSubstr("row 2: time_s is nan"));
  windows = regular_windows(3, 60.0, 60.0);
  windows.centre_s[2] = 10.0;
  EXPECT_THAT(message(windows), testing::HasSubstr("rows of a run must be in time order"));
  windows = regular_windows(3, 60.0, 60.0);
  windows.run_begin = {0};
  EXPECT_THAT(message(windows), testing::HasSubstr("as many durations as rows"));
}

TEST(MakeWhitener, RefusesNoNoiseAndNegativeNoise) {
  const Windows windows = regular_windows(3, 60.0, 60.0);
  EXPECT_FALSE(make_whitener(windows, {}));
  EXPECT_FALSE(make_whitener(windows, {0.001, -0.1, 0.0, 0.0}));
  EXPECT_FALSE(noise_covariance(windows, {}));
  EXPECT_FALSE(make_whitener(regular_windows(0, 60.0, 60.0), kNavigation));
}

TEST(IndependentWhitener, DividesByTheStandardDeviations) {
  const auto whitener = make_independent_whitener(Eigen::Vector2d(2.0, 4.0));
  const Eigen::Vector2d y(1.0, 1.0);
  EXPECT_EQ(whitener->whiten(y), Eigen::Vector2d(0.5, 0.25));
  EXPECT_EQ(whitener->colour(y), Eigen::Vector2d(2.0, 4.0));
  EXPECT_EQ(whitener->colour_transposed(y), Eigen::Vector2d(2.0, 4.0));
  EXPECT_EQ(whitener->standard_deviation(), Eigen::Vector2d(2.0, 4.0));
  EXPECT_NEAR(whitener->log_determinant(), 2.0 * std::log(8.0), 1e-12);
}

}  // namespace
}  // namespace fogbench::model
