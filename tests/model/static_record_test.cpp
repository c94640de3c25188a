#include "model/noise/static_record.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace fogbench::model {
namespace {

using testing::HasSubstr;

Table record() {
  Table table;
  table.set_column("rate_deg_per_h", {1.0, 2.0, 3.0, 4.0});
  table.set_column("time_s", {10.0, 20.0, 30.001, 40.0});
  return table;
}

TEST(StaticRecord, TakesTheIntervalFromTheTimes) {
  const auto result = static_record(record());
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_NEAR(result->interval_s, 10.0, 0.002);
  EXPECT_EQ(result->rate_deg_per_h.size(), 4u);
}

TEST(StaticRecord, TakesTheIntervalAsGivenWhereThereAreNoTimes) {
  Table table;
  table.set_column("rate_deg_per_h", {1.0, 2.0, 3.0});
  EXPECT_EQ(static_record(table, "rate_deg_per_h", 0.5)->interval_s, 0.5);
  EXPECT_THAT(static_record(table).error().message, HasSubstr("no column time_s"));
}

TEST(StaticRecord, RefusesGapsRunsAndMissingValues) {
  const auto message = [](const Table& table, const char* column = "rate_deg_per_h") {
    const auto result = static_record(table, column);
    return result ? std::string() : result.error().message;
  };
  Table table = record();
  table.set_column("time_s", {10.0, 20.0, 30.0, 90.0});
  EXPECT_THAT(message(table), HasSubstr("row 4: 60 s after the row before; a constant 10 s"));
  table = record();
  table.set_column("rate_deg_per_h", {1.0, std::nan(""), 3.0, 4.0});
  EXPECT_THAT(message(table), HasSubstr("row 2: rate_deg_per_h is missing"));
  table = record();
  table.set_run({.values = {"1", "2"}, .index = {0, 0, 1, 1}});
  EXPECT_THAT(message(table), HasSubstr("row 3: run 2 after run 1"));
  EXPECT_THAT(message(record(), "omega"), HasSubstr("no column omega"));
  Table one;
  one.set_column("rate_deg_per_h", {1.0});
  one.set_column("time_s", {1.0});
  EXPECT_THAT(message(one), HasSubstr("one row"));
}

}  // namespace
}  // namespace fogbench::model
