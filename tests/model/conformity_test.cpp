#include "model/compare/conformity.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "model/compare/contrast.hpp"
#include "model/table/table.hpp"

namespace fogbench::model {
namespace {

using config::LimitsConfig;
using testing::HasSubstr;

LimitsConfig limits(std::vector<config::Limit> list, int tests = 1) {
  LimitsConfig out;
  out.name = "technical conditions";
  out.tests = tests;
  out.limits = std::move(list);
  return out;
}

config::Limit within(const std::string& quantity, double minimum, double maximum) {
  config::Limit limit;
  limit.quantity = quantity;
  limit.minimum = minimum;
  limit.maximum = maximum;
  return limit;
}

Judged judged(const std::vector<Measured>& measured, const LimitsConfig& config) {
  auto result = judge_results(measured, config);
  EXPECT_TRUE(result) << result.error().message;
  return *result;
}

TEST(Conformity, GuardBandStandsOnEitherSideOfTheLimit) {
  EXPECT_EQ(judge(0.25, 0.0625, -0.5, 0.5), Conformity::kPass);
  EXPECT_EQ(judge(0.4375, 0.0625, -0.5, 0.5), Conformity::kPass) << "value + U at the limit";
  EXPECT_EQ(judge(0.45, 0.0625, -0.5, 0.5), Conformity::kIndeterminate);
  EXPECT_EQ(judge(0.55, 0.0625, -0.5, 0.5), Conformity::kIndeterminate);
  EXPECT_EQ(judge(0.5625, 0.0625, -0.5, 0.5), Conformity::kIndeterminate)
      << "value - U at the limit";
  EXPECT_EQ(judge(0.57, 0.0625, -0.5, 0.5), Conformity::kFail);
  EXPECT_EQ(judge(-0.57, 0.0625, -0.5, 0.5), Conformity::kFail);
  EXPECT_EQ(judge(-0.45, 0.0625, -0.5, 0.5), Conformity::kIndeterminate);
  EXPECT_EQ(judge(0.0, 2.0, -0.5, 0.5), Conformity::kIndeterminate) << "U wider than the limits";
  EXPECT_EQ(judge(-9.0, 0.0625, {}, 0.5), Conformity::kPass) << "no minimum";
}

TEST(Conformity, WhatIsNotANumberNeverPasses) {
  EXPECT_EQ(judge(kMissing, 0.1, {}, 0.5), Conformity::kIndeterminate);
  EXPECT_EQ(judge(0.1, kMissing, {}, 0.5), Conformity::kIndeterminate);
  EXPECT_EQ(judge(0.1, HUGE_VAL, -0.5, 0.5), Conformity::kIndeterminate);
}

TEST(Conformity, AMissingQuantityIsSaidToBeMissing) {
  const Judged all = judged({{"K_z", "1", "deg/h", 0.0, 0.01}},
                            limits({within("K_z", -1, 1), within("K_x", -1, 1)}));
  EXPECT_EQ(all.overall, Conformity::kIndeterminate);
  ASSERT_EQ(all.results.size(), 2U);
  EXPECT_EQ(all.results[0].verdict, Conformity::kPass);
  EXPECT_EQ(all.results[1].quantity, "K_x");
  EXPECT_EQ(all.results[1].test, "");
  EXPECT_EQ(all.results[1].tests_measured, 0);
  EXPECT_EQ(all.results[1].verdict, Conformity::kIndeterminate);
}

TEST(Conformity, AnUndeterminedCoefficientDoesNotCountAsMeasured) {
  const Judged all =
      judged({{"K_z", "1", "deg/h", 0.0, 0.01}, {"K_z", "2", "deg/h", kMissing, kMissing}},
             limits({within("K_z", -1, 1)}, 2));
  EXPECT_EQ(all.overall, Conformity::kIndeterminate);
  ASSERT_EQ(all.results.size(), 3U);
  EXPECT_EQ(all.results[2].tests_measured, 1);
  EXPECT_EQ(all.results[2].tests_expected, 2);
}

TEST(Conformity, OneTestIsNotTwo) {
  config::Limit once = within("N", -1, 1);
  once.tests = 1;
  const std::vector<Measured> measured{{"K_z", "1", "deg/h", 0.0, 0.01}, {"N", "1", "", 0.0, 0.01}};
  EXPECT_EQ(judged(measured, limits({within("K_z", -1, 1)}, 2)).overall,
            Conformity::kIndeterminate);
  EXPECT_EQ(judged(measured, limits({once}, 2)).overall, Conformity::kPass);
}

TEST(Conformity, AFailOutweighsWhatIsUnknown) {
  EXPECT_EQ(worst_of(Conformity::kIndeterminate, Conformity::kFail), Conformity::kFail);
  EXPECT_EQ(worst_of(Conformity::kFail, Conformity::kPass), Conformity::kFail);
  EXPECT_EQ(worst_of(Conformity::kPass, Conformity::kIndeterminate), Conformity::kIndeterminate);
  EXPECT_EQ(worst_of(Conformity::kPass, Conformity::kPass), Conformity::kPass);
}

TEST(Conformity, UncertaintyFollowsTheLimitsFactorAndTheDegreesOfFreedom) {
  LimitsConfig three = limits({within("a", -1, 1), within("b", -1, 1)});
  three.coverage_factor = 3.0;
  const Judged all = judged({{"a", "1", "", 0.0, 0.1}, {"b", "1", "", 0.0, 0.1, 2.5}}, three);
  EXPECT_DOUBLE_EQ(all.results[0].expanded_uncertainty, 0.3);
  EXPECT_DOUBLE_EQ(all.results[1].expanded_uncertainty, 0.375);
}

TEST(Conformity, ChangeFromTestToTestHasTheUncertaintyOfBoth) {
  config::Limit limit = within("K_z", -1, 1);
  limit.repeatability = 0.3;
  const auto with = [&](double second) {
    return judged({{"K_z", "1", "deg/h", 0.25, 0.03}, {"K_z", "2", "deg/h", second, 0.04}},
                  limits({limit}));
  };
  const Judged kept = with(0.45);
  ASSERT_EQ(kept.repeats.size(), 1U);
  EXPECT_NEAR(kept.repeats[0].difference, 0.2, 1e-12);
  EXPECT_NEAR(kept.repeats[0].expanded_uncertainty, 0.1, 1e-12);
  EXPECT_TRUE(kept.repeats[0].significant);
  EXPECT_FALSE(with(0.34).repeats[0].significant);
  EXPECT_EQ(with(0.44).overall, Conformity::kPass);
  EXPECT_EQ(with(0.50).overall, Conformity::kIndeterminate);
  EXPECT_EQ(with(-0.25).overall, Conformity::kFail) << "either way";
}

TEST(Conformity, ALimitedChangeThatNobodyMeasuredIsIndeterminate) {
  config::Limit limit;
  limit.quantity = "K_z";
  limit.repeatability = 0.3;
  const Judged all = judged({{"K_z", "1", "deg/h", 0.25, 0.03}}, limits({limit}));
  ASSERT_EQ(all.results.size(), 1U);
  EXPECT_EQ(all.results[0].verdict, Conformity::kPass) << "only its change is limited";
  EXPECT_EQ(all.overall, Conformity::kIndeterminate);
}

TEST(Conformity, AQuantityWithoutALimitIsComparedAndNotJudged) {
  const Judged all = judged(
      {{"K_z", "1", "", 0.0, 0.01}, {"bias", "1", "", 0.0, 0.01}, {"bias", "2", "", 9.0, 0.01}},
      limits({within("K_z", -1, 1)}));
  ASSERT_EQ(all.repeats.size(), 1U);
  EXPECT_FALSE(all.repeats[0].verdict.has_value());
  EXPECT_EQ(all.overall, Conformity::kPass);
}

TEST(Conformity, ALimitInAnotherUnitIsRefused) {
  LimitsConfig config = limits({within("K_z", -1, 1)});
  config.limits[0].unit = "deg/s";
  const auto result = judge_results({{"K_z", "1", "deg/h per 100 uT", 0.0, 0.01}}, config);
  ASSERT_FALSE(result);
  EXPECT_THAT(
      result.error().message,
      HasSubstr("K_z is limited in \"deg/s\"; the results have it in \"deg/h per 100 uT\""));
}

TEST(Contrast, AddsWhiteNoiseInSquaresAndDriftWithTheDistance) {
  FitResult fit;
  fit.coloured = true;
  fit.noise.noise.angle_random_walk_deg_per_sqrt_h = 0.01;  // 0.06 deg/h in 100 s
  const auto difference = [&](double apart_s) {
    const auto error = contrast_standard_error(
        {{-1.0, 1000.0, 100.0, 0.06}, {1.0, 1000.0 + apart_s, 100.0, 0.06}}, fit);
    EXPECT_TRUE(error) << error.error().message;
    return *error;
  };
  EXPECT_NEAR(difference(200.0), 0.06 * std::sqrt(2.0), 1e-9);
  EXPECT_NEAR(difference(20000.0), 0.06 * std::sqrt(2.0), 1e-9);
  fit.noise.noise.rate_random_walk_deg_per_h_per_sqrt_h = 0.1;
  EXPECT_NEAR(std::pow(difference(7200.0), 2) - 2.0 * 0.06 * 0.06, 0.01 * 2.0, 1e-3)
      << "K^2 times two hours";
}

TEST(Contrast, IndependentNoiseCountsTheResidualDeviation) {
  FitResult fit;
  fit.residual_standard_deviation = 0.5;
  EXPECT_DOUBLE_EQ(*contrast_standard_error({{1.0, 10, 1, 0}, {-1.0, 20, 1, 0}}, fit),
                   0.5 * std::sqrt(2.0));
}

TEST(Contrast, OverlappingWindowsAreRefused) {
  FitResult fit;
  fit.coloured = true;
  fit.noise.noise.angle_random_walk_deg_per_sqrt_h = 0.01;
  EXPECT_FALSE(contrast_standard_error({{1.0, 10, 100, 0}, {-1.0, 20, 100, 0}}, fit));
}

}  // namespace
}  // namespace fogbench::model
