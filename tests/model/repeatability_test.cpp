#include "model/compare/repeatability.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace fogbench::model {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using testing::ElementsAre;
using testing::HasSubstr;

const std::vector<std::string> kNames{"magnetic_linear_x", "magnetic_linear_y",
                                      "magnetic_linear_z"};
constexpr auto kUnit = "deg/h per 100 uT";

// The published tables (config/data/paper-magnetic-device*.csv), test 1 and test 2.
const RunCoefficients kDevice1[] = {{"1", Vector3d(-0.015, -0.008, -0.055), {}},
                                    {"2", Vector3d(0.009, 0.006, -0.041), {}}};
const RunCoefficients kDevice2[] = {{"1", Vector3d(-0.037, -0.576, -0.253), {}},
                                    {"2", Vector3d(-0.043, -0.375, -0.145), {}}};

TEST(ChangeBetween, FindsThatDevice2ShrankAsAWhole) {
  const RunChange change = change_between(kDevice2[0], kDevice2[1], kNames, kUnit);
  EXPECT_NEAR(change.common_scale, 0.641, 0.002);
  EXPECT_NEAR(change.scale_standard_error, 0.03, 0.005);
  EXPECT_NEAR(change.angle_deg, 3.75, 0.05);
  EXPECT_TRUE(change.scale_changed);
  EXPECT_NEAR(change.p_repeat, 0.0096, 0.0005);  // F(1, 2) = 103
  EXPECT_THAT(change.says, HasSubstr("shrank together: one common scale 0.64 +- 0.03"));
  EXPECT_THAT(change.says, HasSubstr("direction is kept to 3.8 deg"));
  EXPECT_THAT(change.says, HasSubstr("That is not noise (p = 0.0096)"));
  EXPECT_THAT(change.says, HasSubstr("no noise is stated: the yardstick is"));
}

TEST(ChangeBetween, FindsNoChangeInDevice1) {
  const RunChange change = change_between(kDevice1[0], kDevice1[1], kNames, kUnit);
  EXPECT_FALSE(change.scale_changed);
  EXPECT_NEAR(change.p_repeat, 0.47, 0.02);
  EXPECT_THAT(change.says, HasSubstr("did not change by more than noise explains"));
}

TEST(JudgeByScatter, CannotTellDevice1sXAndYFromZero) {
  const auto says = judge_by_scatter({kDevice1[0], kDevice1[1]}, kNames, kUnit);
  ASSERT_EQ(says.size(), 4u);
  EXPECT_THAT(says[0], HasSubstr("0.013 deg/h per 100 uT for one run"));
  EXPECT_THAT(says[0], HasSubstr("(3 degrees of freedom)"));
  EXPECT_THAT(says[1], HasSubstr("magnetic_linear_x: -0.015 and 0.009 in the runs"));
  EXPECT_THAT(says[1], HasSubstr(": not distinguishable from zero."));
  EXPECT_THAT(says[2], HasSubstr(": not distinguishable from zero."));
  EXPECT_THAT(says[3], HasSubstr("mean -0.048 +- 0.03 deg/h per 100 uT (95 %): distinguishable"));
}

TEST(ChangeBetween, UsesTheNoiseThatIsKnown) {
  const MatrixXd tight = 1e-6 * MatrixXd::Identity(3, 3), loose = 0.04 * MatrixXd::Identity(3, 3);
  const VectorXd a = Vector3d(0.1, -0.2, 0.3);
  const auto change = [&](const VectorXd& b, const MatrixXd& covariance) {
    return change_between({"1", a, covariance}, {"2", b, covariance}, kNames, kUnit);
  };
  const RunChange scaled = change(1.5 * a, tight);
  EXPECT_TRUE(scaled.scale_changed);
  EXPECT_NEAR(scaled.common_scale, 1.5, 1e-6);
  EXPECT_NEAR(scaled.angle_deg, 0.0, 1e-4);
  EXPECT_THAT(scaled.says, HasSubstr("grew together"));
  // sd of b - s a over |a|, to first order: sqrt(1 + s^2) sigma / |a|
  EXPECT_NEAR(scaled.scale_standard_error, std::sqrt(3.25) * 1e-3 / a.norm(), 1e-4);

  const RunChange turned = change(Vector3d(0.3, 0.2, -0.1), tight);
  EXPECT_THAT(turned.says, HasSubstr("does not explain how: their direction turned by"));
  EXPECT_LT(turned.p_repeat, 1e-6);

  const RunChange same = change(1.1 * a, loose);
  EXPECT_FALSE(same.scale_changed);
  EXPECT_THAT(same.says, HasSubstr("did not change by more than noise explains"));
}

TEST(ChangeBetween, RaisesNoFalseAlarmMoreOftenThanItSays) {
  std::mt19937_64 random(8);
  std::normal_distribution<double> normal;
  int alarms_known = 0, alarms_unknown = 0;
  constexpr int kTrials = 1000;
  for (int i = 0; i < kTrials; ++i) {
    VectorXd a = Vector3d(0.1, -0.5, 0.2), b = a;
    for (double& value : a) value += 0.02 * normal(random);
    for (double& value : b) value += 0.02 * normal(random);
    const MatrixXd covariance = 0.0004 * MatrixXd::Identity(3, 3);
    const RunChange known =
        change_between({"1", a, covariance}, {"2", b, covariance}, kNames, kUnit);
    alarms_known += known.scale_changed || known.p_repeat < 0.05;
    alarms_unknown += change_between({"1", a, {}}, {"2", b, {}}, kNames, kUnit).scale_changed;
  }
  EXPECT_NEAR(alarms_known, 0.05 * kTrials, 0.02 * kTrials);
  EXPECT_NEAR(alarms_unknown, 0.05 * kTrials, 0.02 * kTrials);
}

TEST(ChangeBetween, SurvivesZerosAndExactRepeats) {
  const VectorXd zero = VectorXd::Zero(3);
  EXPECT_FALSE(change_between({"1", zero, {}}, {"2", zero, {}}, kNames, kUnit).scale_changed);
  const VectorXd a = Vector3d(0.1, 0.2, 0.3);
  const RunChange same = change_between({"1", a, {}}, {"2", a, {}}, kNames, kUnit);
  EXPECT_FALSE(same.scale_changed);
  EXPECT_NEAR(same.common_scale, 1.0, 1e-3);
  const auto says = judge_by_scatter({{"1", zero, {}}, {"2", zero, {}}}, kNames, kUnit);
  EXPECT_THAT(says[1], HasSubstr("not distinguishable from zero"));
}

}  // namespace
}  // namespace fogbench::model
