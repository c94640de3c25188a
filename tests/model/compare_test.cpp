#include "model/compare/compare.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "model/compare/region_noise.hpp"
#include "tests/model/models.hpp"

namespace fogbench::model {
namespace {

using config::ModelFile;
using config::ModelTerm;
using testing::AnyOf;
using testing::Contains;
using testing::HasSubstr;

// config/models/paper-thermal.json: the published coefficients.
ModelFile published_thermal_model() {
  return model_of({term("bias", 1.197), term("temperature_linear", -0.108),
                   term("temperature_quadratic", 0.004)});
}

TEST(Compare, ShowsThatThePublishedCoefficientsMissThePublishedTable) {
  const auto result = compare(published_thermal(), published_thermal_model(), {.as_is = true});
  ASSERT_TRUE(result) << result.error().message;
  ASSERT_EQ(result->regions.size(), 6u);  // every set point is a range of its own
  const Region& worst = result->regions.front();
  EXPECT_EQ(worst.variable, "temperature_c");
  EXPECT_EQ(worst.from, 55.0);
  EXPECT_NEAR(worst.observed - worst.residual, 2.149, 1e-9);
  EXPECT_NEAR(worst.residual, -0.585, 1e-9);
  EXPECT_NEAR(worst.z, -0.585 / 0.019, 1e-6);
  EXPECT_LT(worst.p_family_wise, 1e-10);
  EXPECT_LT(result->p_adequate, 1e-10);
  EXPECT_THAT(result->sentences,
              Contains(HasSubstr("At 55 degC the model is 0.585 deg/h above the measurements (z = "
                                 "30.8, p < 0.0001)")));
  EXPECT_THAT(result->sentences,
              Contains(HasSubstr("worst of 6; the model gives 2.149, the measurements 1.564")));
}

TEST(Compare, SaysWhenRoundingOfTheGivenDigitsCouldExplainTheMiss) {
  const auto rounded = compare(published_thermal(), published_thermal_model(), {.as_is = true});
  ASSERT_TRUE(rounded);
  EXPECT_THAT(rounded->sentences,
              Contains(HasSubstr("temperature_quadratic (0.004 +- 0.0005) moves the model there by "
                                 "0.58 deg/h")));
  ModelFile exact = published_thermal_model();
  exact.terms[2].coefficient = 0.0040001;
  const auto digits = compare(published_thermal(), exact, {.as_is = true});
  ASSERT_TRUE(digits);
  EXPECT_THAT(digits->sentences, Not(Contains(HasSubstr("Rounding"))));
}

TEST(Compare, FindsNothingWrongWithTheLeastSquaresQuadratic) {
  const ModelFile model =
      model_of({term("bias"), term("temperature_linear"), term("temperature_quadratic")});
  const auto result = compare(published_thermal(), model, {});
  ASSERT_TRUE(result);
  EXPECT_NEAR(result->fit.rms, 0.05518, 1e-5);
  EXPECT_GT(result->p_adequate, 0.05);
  EXPECT_THAT(result->sentences, Contains(HasSubstr("by no more than noise explains")));
}

Table published_magnetic(std::vector<double> rates) {
  Table table;
  table.set_column("rate_deg_per_h", std::move(rates));
  table.set_column("field_x_ut", {100, 0, 0, 100, 0, 0});
  table.set_column("field_y_ut", {0, 100, 0, 0, 100, 0});
  table.set_column("field_z_ut", {0, 0, 100, 0, 0, 100});
  table.set_run({.values = {"1", "2"}, .index = {0, 0, 0, 1, 1, 1}});
  return table;
}

const ModelFile kMagnetic =
    model_of({term("magnetic_linear_x"), term("magnetic_linear_y"), term("magnetic_linear_z")});

TEST(Compare, SaysThatDevice1sXAndYAreNotDistinguishableFromZero) {
  const auto result =
      compare(published_magnetic({-0.015, -0.008, -0.055, 0.009, 0.006, -0.041}), kMagnetic, {});
  ASSERT_TRUE(result) << result.error().message;
  for (const char* axis : {"magnetic_linear_x: ", "magnetic_linear_y: "}) {
    EXPECT_THAT(result->sentences,
                Contains(AllOf(HasSubstr(axis), HasSubstr("not distinguishable from zero"))));
  }
  EXPECT_THAT(result->sentences, Contains(AllOf(HasSubstr("magnetic_linear_z: "),
                                                HasSubstr(": distinguishable from zero"))));
  ASSERT_EQ(result->changes.size(), 1u);
  EXPECT_FALSE(result->changes[0].scale_changed);
}

TEST(Compare, SaysThatDevice2ShrankAsAWhole) {
  const auto result =
      compare(published_magnetic({-0.037, -0.576, -0.253, -0.043, -0.375, -0.145}), kMagnetic, {});
  ASSERT_TRUE(result);
  ASSERT_EQ(result->changes.size(), 1u);
  EXPECT_TRUE(result->changes[0].scale_changed);
  EXPECT_NEAR(result->changes[0].common_scale, 0.64, 0.005);
  EXPECT_THAT(result->sentences, Contains(HasSubstr("shrank together")));
  EXPECT_THAT(result->sentences, Contains(HasSubstr("leave no range free to differ")));
}

const ModelFile kAxis = model_of({term("bias"), term("magnetic_linear_z")});

TEST(Compare, FindsTheBranchOnWhichTheModelFails) {
  const auto result = compare(noisy_loops(kNavigation, 3, 3, 0.05), kAxis, {});
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_TRUE(result->fit.coloured);
  EXPECT_LT(result->p_adequate, 0.05);
  EXPECT_THAT(result->regions.front().where, HasSubstr("segment coil_z/"));
  EXPECT_NEAR(result->noise_floor, 0.001 / std::sqrt(0.05), 0.001);
  EXPECT_GT(result->fit.rms, 1.5 * result->noise_floor);
}

TEST(Compare, HoldsGivenCoefficientsAgainstColouredNoise) {
  ModelFile off = kAxis;
  off.terms[0].coefficient = 0.5;
  off.terms[1].coefficient = 0.30;
  const auto result = compare(noisy_loops(kNavigation, 4, 3, 0.0), off, {.as_is = true});
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_LT(result->p_adequate, 0.01);
  EXPECT_TRUE(std::any_of(result->regions.begin(), result->regions.end(), [](const Region& r) {
    return r.variable == "field_z_ut" && r.p_family_wise < 0.05;
  }));
}

TEST(Compare, HasNoRangesToLookAtInAConstantTable) {
  Table table;
  table.set_column("rate_deg_per_h", {1.0, 1.0, 1.0});
  const auto result = compare(table, model_of({term("bias")}), {});
  ASSERT_TRUE(result);
  EXPECT_TRUE(result->regions.empty());
  EXPECT_EQ(result->p_adequate, 1.0);
}

TEST(Compare, SurvivesAPerfectFit) {
  Table table;
  table.set_column("rate_deg_per_h", {1.0, 2.0, 3.0, 4.0});
  table.set_column("temperature_c", {21.0, 22.0, 23.0, 24.0});
  const auto result = compare(table, model_of({term("bias"), term("temperature_linear")}), {});
  ASSERT_TRUE(result);
  for (const Region& region : result->regions) EXPECT_TRUE(std::isfinite(region.z));
}

TEST(Compare, SaysThatNothingIsKnownOfTheNoiseWhenNothingIs) {
  Table table;
  table.set_column("rate_deg_per_h", {1.0, 2.0});
  table.set_column("temperature_c", {21.0, 31.0});
  const auto result = compare(table, model_of({term("bias", 1.0), term("temperature_linear", 0.2)}),
                              {.as_is = true});
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_FALSE(result->noise_known);
  EXPECT_TRUE(std::isnan(result->noise_floor));
  EXPECT_NEAR(result->regions.front().residual, -1.0, 1e-12);
  EXPECT_THAT(result->sentences, Contains(HasSubstr("cannot be said")));
}

TEST(Compare, PassesOnWhatTheFitRefuses) {
  const auto result = compare(published_thermal(), model_of({term("no_such_effect")}), {});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kBadInput);
}

TEST(Compare, WritesNoNumberThatIsNone) {
  for (bool as_is : {false, true}) {
    const auto result = compare(published_thermal(), published_thermal_model(), {.as_is = as_is});
    ASSERT_TRUE(result);
    EXPECT_THAT(result->sentences, Not(Contains(HasSubstr("nan"))));
  }
}

TEST(Tangent, IsTheRegressorOrTheDerivativeByTheInnerParameter) {
  Table table;
  table.set_column("rate_deg_per_h", {1.0, 0.7, 0.5, 0.37, 0.3, 0.24});
  table.set_column("time_s", {0.0, 600.0, 1200.0, 1800.0, 2400.0, 3000.0});
  const auto fitted = fit(table, model_of({term("bias"), term("warm_up")}), {});
  ASSERT_TRUE(fitted) << fitted.error().message;
  ASSERT_EQ(fitted->covariance.rows(), 3);
  const double tau = fitted->estimates[2].value, amplitude = fitted->estimates[1].value;
  for (Eigen::Index k = 0; k < 3; ++k) {
    const auto column = tangent(table, *fitted, k);
    ASSERT_TRUE(column);
    const double x = 1200.0 / tau;
    const double expected[] = {1.0, std::exp(-x), amplitude * x / tau * std::exp(-x)};
    EXPECT_NEAR((*column)[2], expected[k], 2e-4 * std::abs(expected[k])) << k;
  }
}

}  // namespace
}  // namespace fogbench::model
