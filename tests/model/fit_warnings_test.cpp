#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "model/fit/fit.hpp"
#include "tests/model/models.hpp"

namespace fogbench::model {
namespace {

using testing::HasSubstr;

TEST(FitWarnings, WarnsOfACoefficientThatTheDataHardlyExcite) {
  Table table;
  std::vector<double> field, rate;
  for (int i = 0; i < 40; ++i) {
    field.push_back(i % 2 == 0 ? 0.001 : -0.001);  // a nanotesla
    rate.push_back(0.7 + 0.01 * std::sin(7.0 * i * i));
  }
  table.set_column("field_x_ut", field);
  table.set_column("rate_deg_per_h", rate);
  // Of the catalogue's own it would be known that nothing excites it.
  config::ModelFile model = model_of_effects({"bias"});
  model.terms.push_back(term("slope"));
  model.terms.back().expression = "field_x_ut / 100";
  const auto faint = fit(table, model, {});
  ASSERT_TRUE(faint);
  EXPECT_THAT(faint->warnings,
              testing::ElementsAre(testing::AllOf(HasSubstr("slope = "),
                                                  HasSubstr("not determined by these data"))));
  // A coefficient that is merely not distinguishable from zero is a result.
  for (double& h : field) h *= 1e5;
  table.set_column("field_x_ut", field);
  const auto excited = fit(table, model, {});
  ASSERT_TRUE(excited);
  EXPECT_LT(std::abs(excited->estimates[1].value), 2.0 * excited->estimates[1].standard_error);
  EXPECT_THAT(excited->warnings, testing::IsEmpty());
}

TEST(FitWarnings, SaysThatAnExactFitLeavesNothingToTellUncertaintiesFrom) {
  Table table;
  table.set_column("temperature_c", {21, 31, 41, 51, 61});
  table.set_column("rate_deg_per_h", {1, 2, 3, 4, 5});
  const auto result = fit(table, model_of_effects({"bias", "temperature_linear"}), {});
  ASSERT_TRUE(result);
  EXPECT_THAT(result->warnings, testing::Contains(HasSubstr("meets every row exactly")));
}

}  // namespace
}  // namespace fogbench::model
