#include "model/compare/loops.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace fogbench::model {
namespace {

Table timed_table(const std::string& variable, const std::vector<double>& values) {
  Table table;
  std::vector<double> time;
  for (std::size_t i = 0; i < values.size(); ++i) time.push_back(static_cast<double>(i));
  table.set_column(variable, values);
  table.set_column("time_s", time);
  return table;
}

std::vector<Branch> branches(const Table& table, const std::string& variable) {
  return branches_of(Signals(table, 21.0), variable);
}

TEST(BranchesOf, FollowASweepUpAndDownStopByStop) {
  const Table table = timed_table(
      "field_z_ut", {0, 0, 100, 200, 300, 200, 100, 0, -100, -200, -300, -200, -100, 0});
  const auto found = branches(table, "field_z_ut");
  ASSERT_EQ(found.size(), 3u);
  EXPECT_TRUE(found[0].rising);
  EXPECT_FALSE(found[0].continues);
  EXPECT_FALSE(found[1].rising);
  EXPECT_TRUE(found[1].continues);
  EXPECT_TRUE(found[2].rising);
  EXPECT_THAT(found[0].stops.front(), testing::ElementsAre(0, 1)) << "the two rows at zero";
  EXPECT_THAT(found[0].stops, testing::SizeIs(4));
  EXPECT_THAT(found[1].stops, testing::SizeIs(7));
}

TEST(BranchesOf, GatherANoisyRampIntoFewStops) {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, 0.05);
  std::vector<double> values;
  for (int i = 0; i < 4000; ++i)
    values.push_back(25.0 + 0.015 * std::min(i, 4000 - i) + noise(random));
  const auto found = branches(timed_table("temperature_c", values), "temperature_c");
  ASSERT_EQ(found.size(), 2u);
  EXPECT_TRUE(found[0].rising);
  EXPECT_FALSE(found[1].rising);
  EXPECT_LE(found[0].stops.size(), 45u);
  std::size_t rows = 0;
  for (const Branch& branch : found) {
    for (const auto& stop : branch.stops) rows += stop.size();
  }
  EXPECT_NEAR(static_cast<double>(rows), 4000.0, 1.0) << "the turning row stands on both";
}

TEST(BranchesOf, SeeNoLoopInOneDirectionInNoiseOrAtRest) {
  std::vector<double> rising, scatter, rest(50, 20.0);
  std::mt19937 random(2);
  std::normal_distribution<double> noise(25.0, 0.1);
  for (int i = 0; i < 200; ++i) {
    rising.push_back(0.1 * i);
    scatter.push_back(noise(random));
  }
  EXPECT_THAT(branches(timed_table("temperature_c", rising), "temperature_c"), testing::IsEmpty());
  EXPECT_THAT(branches(timed_table("temperature_c", scatter), "temperature_c"), testing::IsEmpty());
  EXPECT_THAT(branches(timed_table("temperature_c", rest), "temperature_c"), testing::IsEmpty());
}

TEST(BranchesOf, KeepTheSweepsOfOtherAxesOut) {
  Table table =
      timed_table("field_z_ut", {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -300, 0, 300, 300, 0, -300});
  TextColumn segment{{"coil_x/up", "coil_z/up", "coil_z/down"},
                     {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 2, 2, 2}};
  table.set_segment(segment);
  const auto found = branches(table, "field_z_ut");
  ASSERT_EQ(found.size(), 2u);
  EXPECT_THAT(found[0].stops.front(), testing::ElementsAre(10));
}

}  // namespace
}  // namespace fogbench::model
