#include "model/compare/partition.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

namespace fogbench::model {
namespace {

TEST(RangesOf, AreTheSetPointsOfAList) {
  const std::vector<double> values{31, 35, 40, 45, 50, 55};
  const auto ranges = ranges_of(values);
  ASSERT_EQ(ranges.size(), 6u);
  EXPECT_EQ(ranges[1].from, 35.0);
  EXPECT_EQ(ranges[1].to, 35.0);
}

TEST(RangesOf, AreTheLevelsOfANoisySweep) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0.0, 0.2);
  std::vector<double> values;
  for (int i = 0; i < 500; ++i) values.push_back(50.0 * (i % 13 - 6) + noise(random));
  EXPECT_EQ(ranges_of(values).size(), 13u);
}

TEST(RangesOf, AreQuantilesOfASpread) {
  std::vector<double> values(1000);
  std::iota(values.begin(), values.end(), 0.0);
  values.push_back(std::nan(""));
  const auto ranges = ranges_of(values);
  ASSERT_EQ(ranges.size(), 8u);
  EXPECT_EQ(ranges.front().from, 0.0);
  EXPECT_EQ(ranges.front().to, 124.0);
  EXPECT_EQ(ranges.back().to, 999.0);
}

TEST(RangesOf, DoNotExistForOneValue) {
  EXPECT_TRUE(ranges_of(std::vector<double>{}).empty());
  EXPECT_TRUE(ranges_of(std::vector<double>(10, 21.0)).empty());
  EXPECT_TRUE(ranges_of(std::vector<double>(10, std::nan(""))).empty());
}

TEST(PartitionRows, CutsBySegmentSweepRunAndVariable) {
  constexpr std::size_t kRows = 12;
  std::vector<double> rate(kRows, 1.0), temperature;
  TextColumn run{.values = {"1", "2"}, .index = {}};
  TextColumn segment{.values = {"coil_z/up", "coil_z/down", "coil_x/up"}, .index = {}};
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < kRows; ++i) {
    rows.push_back(i);
    run.index.push_back(i < 6 ? 0 : 1);
    segment.index.push_back(static_cast<std::uint32_t>(i / 4));
    temperature.push_back(i == 11 ? std::nan("") : i < 8 ? 31.0 : 55.0);
  }
  Table table;
  table.set_column("rate_deg_per_h", rate);
  table.set_column("temperature_c", temperature);
  std::vector<double> held_field;
  for (std::size_t i = 0; i < kRows; ++i)
    held_field.push_back(-50.0 + 0.01 * static_cast<double>(i));
  table.set_column("field_x_ut", held_field);  // its sensor's noise is not a variable
  table.set_run(run);
  table.set_segment(segment);
  const auto partitions = partition_rows(table, rows, 21.0);
  ASSERT_EQ(partitions.size(), 4u);
  EXPECT_EQ(partitions[0].ranges[1].where, "segment coil_z/down");
  EXPECT_EQ(partitions[1].ranges[0].where, "sweep coil_z");
  EXPECT_THAT(partitions[1].index, testing::ElementsAre(0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1));
  EXPECT_EQ(partitions[2].ranges[1].where, "run 2");
  EXPECT_EQ(partitions[3].variable, "temperature_c");
  EXPECT_THAT(partitions[3].index, testing::ElementsAre(0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, -1));

  rows.resize(9);  // too few rows a run to speak of a run's mean
  for (const Partition& partition : partition_rows(table, rows, 21.0)) {
    EXPECT_THAT(partition.ranges[0].where, testing::Not(testing::HasSubstr("run")));
  }
}

TEST(PlaceInWords, HasUnitsAndOneNumberForASetPoint) {
  EXPECT_EQ(place_in_words("temperature_c", {"", 50.0, 55.0}), "At 50..55 degC");
  EXPECT_EQ(place_in_words("temperature_c", {"", 54.99, 55.01}), "At 55 degC");
  EXPECT_EQ(place_in_words("field_z_ut", {"", -100.0, 100.0}), "At a field z of -100..100 uT");
  EXPECT_EQ(place_in_words("time_s", {"", 3600.0, 7200.0}), "At a time of 1..2 h");
  EXPECT_EQ(place_in_words("", {"segment coil_z/down", 0.0, 0.0}), "In segment coil_z/down");
  EXPECT_EQ(place_name("field_z_ut", {"", -100.0, 100.0}), "field z of -100..100 uT");
  EXPECT_EQ(place_name("", {"segment coil_z/down", 0.0, 0.0}), "segment coil_z/down");
}

}  // namespace
}  // namespace fogbench::model
