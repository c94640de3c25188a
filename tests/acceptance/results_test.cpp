#include "acceptance/results.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace fogbench::acceptance {
namespace {

using procedures::Point;
using procedures::PointKind;

Point average(const std::string& segment, double rate, double error = 0.01) {
  Point point;
  point.segment = segment;
  point.rate_deg_per_h = rate;
  point.rate_std_error_deg_per_h = error;
  point.field_set_ut = std::nan("");
  return point;
}

Point baseline(double rate, int test = 1) {
  Point point = average("baseline", rate, 0.03);
  point.kind = PointKind::kBaseline;
  point.test = test;
  return point;
}

/// The procedure's 25 levels along `axis`, the rate drawn by `rate(level in 100 uT, position)`.
template <class Rate>
std::vector<Point> sweep(const std::string& name, int axis, Rate rate) {
  std::vector<double> levels;
  for (double level = 0.0; level <= 300.0; level += 50.0) levels.push_back(level);
  for (double level = 250.0; level >= -300.0; level -= 50.0) levels.push_back(level);
  for (double level = -250.0; level <= 0.0; level += 50.0) levels.push_back(level);
  std::vector<Point> points;
  for (const double level : levels) {
    Point point = average(name + "/up", rate(level / 100.0, static_cast<double>(points.size())));
    point.field_set_ut = level;
    point.field_x_ut = point.field_y_ut = point.field_z_ut = 0.3;
    (axis == 0 ? point.field_x_ut : axis == 1 ? point.field_y_ut : point.field_z_ut) = level;
    points.push_back(point);
  }
  return points;
}

TEST(Results, DeviatesFromTheLastBaselineOfTheSameTest) {
  std::vector<Point> points{baseline(1.0), average("t/31", 1.5), baseline(2.0),
                            average("t/35", 2.25), baseline(5.0, 2)};
  points.push_back(average("t/31", 5.125));
  points.back().test = 2;
  points.push_back(average("t/31", 9.0));
  points.back().test = 3;  // a test without a baseline
  const RunResults results = derive_results(points);
  ASSERT_EQ(results.temperature.size(), 4U);
  EXPECT_DOUBLE_EQ(results.temperature[0].deviation_deg_per_h.value, 0.5);
  EXPECT_DOUBLE_EQ(results.temperature[0].deviation_deg_per_h.standard_error,
                   std::hypot(0.01, 0.03));
  EXPECT_DOUBLE_EQ(results.temperature[1].deviation_deg_per_h.value, 0.25);
  EXPECT_DOUBLE_EQ(results.temperature[2].deviation_deg_per_h.value, 0.125);
  EXPECT_TRUE(std::isnan(results.temperature[3].deviation_deg_per_h.value));
}

TEST(Results, LeavesTransientsOut) {
  Point transient = average("heating/31", 3.0);
  transient.kind = PointKind::kTransient;
  const std::vector<Point> points{baseline(1.0), transient};
  EXPECT_TRUE(derive_results(points).temperature.empty());
}

TEST(Results, FindsKAndSlopeOfEachSweep) {
  std::vector<Point> points{baseline(0.7)};
  const char* names[] = {"coil_x", "coil_y", "coil_z"};
  const double slopes[] = {-0.015, -0.576, -0.253};
  for (int axis = 0; axis < 3; ++axis) {
    const auto levels =
        sweep(names[axis], axis, [&](double h, double) { return 0.7 + slopes[axis] * h; });
    points.insert(points.end(), levels.begin(), levels.end());
  }
  const RunResults results = derive_results(points);
  EXPECT_EQ(results.magnetic.size(), 75U);
  ASSERT_EQ(results.sweeps.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const SweepResult& result = results.sweeps[i];
    EXPECT_EQ(result.sweep, names[i]);
    EXPECT_EQ(result.axis, "xyz"[i]);
    EXPECT_EQ(result.points, 25U);
    EXPECT_NEAR(result.k_deg_per_h.value, slopes[i], 1e-12);
    EXPECT_NEAR(result.k_deg_per_h.standard_error, std::sqrt(2.0) * 0.01 / 6.0, 1e-12);
    EXPECT_NEAR(result.slope_deg_per_h.value, slopes[i], 1e-12);
    EXPECT_NEAR(result.intercept_deg_per_h.value, 0.0, 1e-12);
    EXPECT_NEAR(result.closure_deg_per_h.value, 0.0, 1e-12);
  }
}

TEST(Results, ALinearDriftClosesAndARemanenceLeavesMinusThreeTimesItself) {
  const auto drifting = sweep("coil_x", 0, [](double, double i) { return 0.01 * i; });
  const RunResults drift = derive_results(drifting);
  EXPECT_NEAR(drift.sweeps[0].closure_deg_per_h.value, 0.0, 1e-12);
  EXPECT_NEAR(drift.sweeps[0].drift_deg_per_h.value, 0.24, 1e-12);

  const double r = 0.05;  // +r after the positive branch, -r after the negative one
  const auto magnetised = sweep("coil_x", 0, [&](double, double i) {
    return i < 6 ? 0.0 : i < 18 ? r : -r;
  });
  EXPECT_NEAR(derive_results(magnetised).sweeps[0].closure_deg_per_h.value, -3.0 * r, 1e-12);
  EXPECT_NEAR(derive_results(magnetised).sweeps[0].closure_deg_per_h.standard_error,
              std::sqrt(6.0) * 0.01, 1e-12);
}

TEST(Results, TheSlopesErrorIsThatOfTheTextbook) {
  // y = {1, 2, 2, 4} at x = {0, 1, 2, 3}: slope 0.9, RSS 0.7, se = sqrt(0.35 / 5).
  std::vector<Point> points;
  const double rates[] = {1.0, 2.0, 2.0, 4.0};
  for (int i = 0; i < 4; ++i) {
    points.push_back(average("coil_z/up", rates[i]));
    points.back().field_set_ut = points.back().field_z_ut = 100.0 * i;
  }
  const SweepResult result = derive_results(points).sweeps.at(0);
  EXPECT_NEAR(result.slope_deg_per_h.value, 0.9, 1e-12);
  EXPECT_NEAR(result.slope_deg_per_h.standard_error, std::sqrt(0.35 / 5.0), 1e-12);
}

TEST(Results, AnUnfinishedSweepHasNoFiguresThatItCannotHave) {
  std::vector<Point> points{average("coil_x/up", 1.0)};
  points[0].field_set_ut = 0.0;
  const SweepResult result = derive_results(points).sweeps.at(0);
  EXPECT_TRUE(std::isnan(result.k_deg_per_h.value));
  EXPECT_TRUE(std::isnan(result.slope_deg_per_h.value));
  EXPECT_TRUE(std::isnan(result.closure_deg_per_h.value));
}

TEST(Results, TwoTestsOfOneAxisStayApart) {
  auto points = sweep("coil_x", 0, [](double h, double) { return h; });
  auto second = sweep("coil_x", 0, [](double h, double) { return 0.64 * h; });
  for (Point& point : second) point.test = 2;
  points.insert(points.end(), second.begin(), second.end());
  const RunResults results = derive_results(points);
  ASSERT_EQ(results.sweeps.size(), 2U);
  EXPECT_NEAR(results.sweeps[0].k_deg_per_h.value, 1.0, 1e-12);
  EXPECT_NEAR(results.sweeps[1].k_deg_per_h.value, 0.64, 1e-12);
  EXPECT_EQ(results.sweeps[1].test, 2);
}

TEST(Results, NoPointsNoResults) {
  const RunResults results = derive_results({});
  EXPECT_TRUE(results.temperature.empty() && results.magnetic.empty() && results.sweeps.empty());
}

}  // namespace
}  // namespace fogbench::acceptance
