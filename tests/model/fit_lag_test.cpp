// What a thermometer that may read late does to the uncertainty of a fit.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "model/fit/fit.hpp"
#include "tests/model/cut_out_chamber.hpp"

namespace fogbench::model {
namespace {

using testing::HasSubstr;

/// Seven hours in the chamber, of which the thermometer tells late.
Table told_late(double lag_s) {
  Table table =
      cut_out(model_of({term("bias", 0.4), term("temperature_linear", -0.117)}), 7.0, 0, 0.004, 5);
  const auto temperature = table.column("temperature_c");
  const auto rate = table.column("temperature_rate_c_per_h");
  std::vector<double> late;
  for (std::size_t i = 0; i < table.rows(); ++i) {
    late.push_back(temperature[i] - rate[i] * lag_s / 3600.0);
  }
  table.set_column("temperature_c", late);
  return table;
}

FitResult fitted(const Table& table, bool doubt_lag) {
  auto out = fit(table, model_of_effects({"bias", "temperature_linear", "temperature_rate"}),
                 {.doubt_lag = doubt_lag});
  EXPECT_TRUE(out) << out.error().message;
  return std::move(*out);
}

TEST(FitLag, IsPartOfTheUncertaintyOfWhatItMoves) {
  const Table table = told_late(15.0);
  const FitResult sure = fitted(table, false), doubting = fitted(table, true);
  const Estimate &of_rate = doubting.estimates[2], &of_rate_if_sure = sure.estimates[2];
  ASSERT_EQ(of_rate.name, "temperature_rate");
  EXPECT_DOUBLE_EQ(of_rate.value, of_rate_if_sure.value);
  EXPECT_GT(std::abs(of_rate_if_sure.value), 3.0 * of_rate_if_sure.standard_error)
      << "the lag looks like an effect";
  EXPECT_LT(std::abs(of_rate.value), 2.0 * of_rate.standard_error);
  // 19 s of the slope: -0.117 deg/h/degC x 19/3600 h.
  EXPECT_NEAR(of_rate.standard_error, 0.117 * 19.0 / 3600.0, 5e-5);
  ASSERT_FALSE(doubting.warnings.empty());
  EXPECT_THAT(doubting.warnings.back(), HasSubstr("part of the uncertainty of temperature_rate"));
}

TEST(FitLag, IsNoneWhereTheTemperaturesWereFreedOfIt) {
  Table table = told_late(0.0);
  const auto temperature = table.column("temperature_c");
  table.set_column("temperature_start_c", {temperature.begin(), temperature.end()});
  const FitResult sure = fitted(table, false), doubting = fitted(table, true);
  EXPECT_EQ(doubting.estimates[2].standard_error, sure.estimates[2].standard_error);
}

}  // namespace
}  // namespace fogbench::model
