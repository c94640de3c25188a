#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "model/table/average_rows.hpp"
#include "model/table/doubts.hpp"
#include "model/table/inspection.hpp"
#include "model/table/join_tables.hpp"
#include "model/table/time_axis.hpp"
#include "model/table/time_stamp.hpp"

namespace fogbench::model {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kNoon = 1709294400.0;  // 2024-03-01T12:00:00Z

double seconds_of(std::string_view text, SlashDate order = SlashDate::kUnknown) {
  const auto stamp = time_stamp(text, order);
  return stamp ? stamp->seconds : kMissing;
}

TEST(TimeStamp, IsReadInAllTheWaysOfIso8601AndSpreadsheets) {
  for (const char* const noon :
       {"2024-03-01T12:00:00Z", "2024-03-01 12:00:00", "2024-03-01T15:00:00+03:00",
        "2024-03-01T15:00:00.000+0300", "2024-03-01T08:30:00-03:30", "2024-03-01 12:00:00 UTC",
        "01.03.2024 12:00:00", "1.3.2024 12:00", "2024/03/01 12:00:00", "2024-03-01 12:00:00,0"}) {
    EXPECT_EQ(seconds_of(noon), kNoon) << noon;
  }
  EXPECT_EQ(seconds_of("2024-03-01"), kNoon - 43200.0);
  EXPECT_DOUBLE_EQ(seconds_of("2024-03-01T12:00:00.25Z"), kNoon + 0.25);
  EXPECT_EQ(seconds_of("1/3/2024 12:00:00", SlashDate::kDayFirst), kNoon);
  EXPECT_EQ(seconds_of("3/1/2024 12:00:00 PM", SlashDate::kMonthFirst), kNoon);
  EXPECT_EQ(seconds_of("3/1/2024 12:00 AM", SlashDate::kMonthFirst), kNoon - 43200.0);
  EXPECT_EQ(seconds_of("23:59:30"), 86370.0);
}

TEST(TimeStamp, IsNothingElse) {
  for (const char* const text :
       {"", "noon", "12", "1.5", "2024-13-01", "2024-02-30", "2024-03-01T25:00:00Z", "12:60",
        "2024-03-01T12:00:00+99:00", "2024-03-01T12:00:00Z and more", "1.2.3", "31.04.2024",
        "2024-03", "12:00:00 XM", "1-2-2024"}) {
    EXPECT_FALSE(time_stamp(text, SlashDate::kDayFirst)) << text;
  }
}

TEST(TimeAxis, ACounterThatWrapsGoesOnInEachRun) {
  std::vector<double> micros = {4294967000, 4294967200, 104, 304, 4294967100, 4};
  const std::vector<std::uint32_t> run = {0, 0, 0, 0, 1, 1};
  const auto says = settle_counter({.name = "time_s",
                                    .unit = config::find_unit("us"),
                                    .house = config::find_unit("s"),
                                    .is_foreign = true},
                                   run, micros);
  ASSERT_TRUE(says);
  EXPECT_THAT(*says, ElementsAre("the counter of 32 bits wrapped 2 times"));
  EXPECT_NEAR(micros[2] - micros[1], 200e-6, 1e-9);
  EXPECT_NEAR(micros[5] - micros[4], 200e-6, 1e-9);
}

TEST(TimeAxis, ARestartIsNoWrap) {
  std::vector<double> counts = {1000, 1100, 1200, 0, 100};
  const auto says = settle_counter({.name = "time_s"}, {}, counts);
  ASSERT_TRUE(says);
  EXPECT_THAT(counts, ElementsAre(1000, 1100, 1200, 0, 100));
}

TEST(TimeAxis, UnixStampsSayBySizeWhatTheyAreIn) {
  for (const double per_second : {1.0, 1e3, 1e6}) {
    std::vector<double> stamps = {kNoon * per_second, (kNoon + 60) * per_second};
    const auto says = settle_counter(
        {.name = "time_s", .house = config::find_unit("s"), .is_foreign = true}, {}, stamps);
    ASSERT_TRUE(says);
    EXPECT_THAT(stamps, ElementsAre(kNoon, kNoon + 60));
  }
}

Table timed(std::vector<double> time, std::vector<double> rate) {
  Table table;
  table.set_column("time_s", std::move(time));
  table.set_column("rate_deg_per_h", std::move(rate));
  return table;
}

TEST(Doubts, NameTheLikelyCause) {
  EXPECT_THAT(doubts(timed({0, 1, 2, 3}, {0.1, 0.2, 0.1, 0.3})), IsEmpty());
  EXPECT_THAT(doubts(timed({0, 1, 2, 3, 0, 1, 2}, {1, 1, 1, 1, 1, 1, 1})),
              ElementsAre(HasSubstr("falls back from 3 to 0 s at row 5: the logger began anew")));
  EXPECT_THAT(doubts(timed({5, 4, 3, 2, 1}, {1, 1, 1, 1, 1})),
              ElementsAre(HasSubstr("runs backwards at 4 of 5 rows, first at row 2")));
  EXPECT_THAT(doubts(timed({0, 0, 0, 1, 1, 1, 2}, {1, 1, 1, 1, 1, 1, 1})),
              ElementsAre(HasSubstr("repeats in 4 of 7 rows")));
  EXPECT_THAT(doubts(timed({0, 1, 2}, {36000, 36001, 36002})),
              ElementsAre(HasSubstr("perhaps numbers in deg/h that were taken for deg/s")));
  const auto with = [](const char* name, std::vector<double> values) {
    Table table = timed({0, 1, 2}, {1, 1, 1});
    table.set_column(name, std::move(values));
    return doubts(table);
  };
  EXPECT_THAT(with("temperature_c", {294, 300, 310}), ElementsAre(HasSubstr("numbers in K")));
  EXPECT_THAT(with("temperature_c", {-273.15, 25, 26}),
              ElementsAre(HasSubstr("a sensor that reads 0 where it has no value")));
  EXPECT_THAT(with("temperature_c", {25000, 25100, 25200}), ElementsAre(HasSubstr("mdegC")));
  EXPECT_THAT(with("field_x_ut", {48000, 48001, 47999}), ElementsAre(HasSubstr("nT")));
}

TEST(AverageRows, MakesMeansWithTheirStandardErrors) {
  std::vector<double> time, rate;
  for (int i = 0; i < 200; ++i) {
    time.push_back(0.1 * i);
    rate.push_back(i < 100 ? (i % 2 == 0 ? 1.0 : 3.0) : 5.0);
  }
  const auto averaged = average_rows(timed(time, rate), 10.0);
  ASSERT_TRUE(averaged) << averaged.error().message;
  ASSERT_EQ(averaged->rows(), 2U);
  EXPECT_NEAR(averaged->column("time_s")[0], 4.95, 1e-9);
  EXPECT_NEAR(averaged->column("duration_s")[1], 10.0, 1e-9);
  EXPECT_DOUBLE_EQ(averaged->column("rate_deg_per_h")[0], 2.0);
  EXPECT_NEAR(averaged->column("rate_std_error_deg_per_h")[0], std::sqrt(100.0 / 99.0) / 10.0,
              1e-12);
  EXPECT_EQ(averaged->column("rate_std_error_deg_per_h")[1], 0.0);
  const auto too_short = average_rows(timed(time, rate), 0.1);
  ASSERT_FALSE(too_short);
  EXPECT_THAT(too_short.error().message, HasSubstr("rows are 0.1 s apart"));
  EXPECT_FALSE(average_rows(timed({0, 2, 1}, {1, 1, 1}), 5.0));
}

TEST(JoinTables, TakesTheNearestRowWithinTheTolerance) {
  Table thermometer;
  thermometer.set_column("time_s", {0.4, 10.2, 40.0});
  thermometer.set_column("temperature_c", {20, 21, 24});
  const Table gyro = timed({0, 10, 20}, {1, 2, 3});
  const auto joined = join_tables({gyro, thermometer}, {"gyro.csv", "t.csv"}, 1.0);
  ASSERT_TRUE(joined) << joined.error().message;
  const auto temperature = joined->table.column("temperature_c");
  EXPECT_EQ(temperature[0], 20.0);
  EXPECT_EQ(temperature[1], 21.0);
  EXPECT_TRUE(std::isnan(temperature[2]));
  EXPECT_THAT(joined->says, ElementsAre("t.csv: temperature_c joined to 2 of 3 rows, within 1 s"));
  const auto apart = join_tables({gyro, thermometer}, {"gyro.csv", "t.csv"}, 0.1);
  ASSERT_FALSE(apart);
  EXPECT_THAT(apart.error().message, HasSubstr("t.csv: no row is within 0.1 s of one of gyro.csv"));
}

TEST(JoinTables, FilesWithTheSameColumnsGoOnAfterEachOther) {
  const auto joined =
      join_tables({timed({0, 1}, {1, 2}), timed({2, 3}, {3, 4})}, {"a.csv", "b.csv"}, kMissing);
  ASSERT_TRUE(joined) << joined.error().message;
  EXPECT_THAT(joined->table.column("rate_deg_per_h"), ElementsAre(1, 2, 3, 4));
  const auto wrong =
      join_tables({timed({2, 3}, {3, 4}), timed({0, 1}, {1, 2})}, {"b.csv", "a.csv"}, kMissing);
  ASSERT_FALSE(wrong);
  EXPECT_THAT(wrong.error().message, HasSubstr("a.csv: begins at 0 s, expected it after the end"));
}

TEST(Inspection, SeesGapsResolutionAndWhatStandsStill) {
  std::vector<double> time, rate, temperature;
  for (int i = 0; i < 200; ++i) {
    time.push_back(i < 100 ? i : i + 50);
    rate.push_back(0.25 * ((i * 7) % 23));
    temperature.push_back(i >= 40 && i < 60 ? 21.37 : 20.0 + std::fmod(0.6180339887 * i, 1.0) * 3);
    if (i >= 120 && i < 130) rate.back() = 50.0;
  }
  Table table = timed(time, rate);
  table.set_column("temperature_c", temperature);
  const Inspection found = inspect(table);
  ASSERT_TRUE(found.time);
  EXPECT_EQ(found.time->usual_s, 1.0);
  ASSERT_EQ(found.time->gap_count, 1U);
  EXPECT_EQ(found.time->gaps[0].row, 100U);
  ASSERT_EQ(found.columns.size(), 3U);
  const ColumnInspection &of_rate = found.columns[0], &of_temperature = found.columns[1];
  ASSERT_EQ(of_rate.name, "rate_deg_per_h");
  ASSERT_TRUE(of_rate.resolution);
  EXPECT_NEAR(*of_rate.resolution, 0.25, 1e-12);
  ASSERT_TRUE(of_rate.saturated);
  EXPECT_EQ(of_rate.saturated->row, 120U);
  EXPECT_EQ(of_rate.saturated->rows, 10U);
  EXPECT_FALSE(of_rate.stuck);
  ASSERT_TRUE(of_temperature.stuck);
  EXPECT_EQ(of_temperature.stuck->row, 40U);
  EXPECT_FALSE(of_temperature.saturated);
  EXPECT_FALSE(found.columns[2].stuck) << "time does not stand still";
}

}  // namespace
}  // namespace fogbench::model
