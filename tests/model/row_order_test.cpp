#include "model/table/row_order.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace fogbench::model {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr double kNoStamp = std::numeric_limits<double>::quiet_NaN();
const std::string kRate = "rate_deg_per_h";

/// A row each minute; the rates tell the rows apart.
Table minute_rows(std::size_t rows) {
  std::vector<double> time, rate;
  for (std::size_t i = 0; i < rows; ++i) {
    time.push_back(60.0 * static_cast<double>(i));
    rate.push_back(static_cast<double>(i));
  }
  Table out;
  out.set_column("time_s", time);
  out.set_column(kRate, rate);
  return out;
}

Table with_stamp(Table table, std::size_t row, double time_s) {
  const auto given = table.column("time_s");
  std::vector<double> time(given.begin(), given.end());
  time[row] = time_s;
  table.set_column("time_s", time);
  return table;
}

TEST(RowOrder, ARepeatedStampIsTakenFromItsNeighboursAndSaid) {
  const RowOrder order = row_order(with_stamp(minute_rows(12), 5, 240.0), kRate);
  EXPECT_TRUE(order.time_advances);
  EXPECT_THAT(order.rows, SizeIs(12));
  EXPECT_EQ(order.rows[5], 5U);
  EXPECT_DOUBLE_EQ(order.time_s[5], 300.0);
  ASSERT_THAT(order.notes, SizeIs(1));
  EXPECT_THAT(order.notes[0], HasSubstr("row 6 of the data (time_s 240, taken as 300)"));
}

TEST(RowOrder, AStampThatStepsBackLeavesTheRowInItsPlace) {
  for (const double stamp : {0.0, 70.0, 1e6}) {
    const RowOrder order = row_order(with_stamp(minute_rows(24), 9, stamp), kRate);
    EXPECT_EQ(order.rows[9], 9U) << stamp;
    EXPECT_DOUBLE_EQ(order.time_s[9], 540.0) << stamp;
    EXPECT_THAT(order.notes, SizeIs(1)) << stamp;
  }
}

TEST(RowOrder, ABlankStampIsTakenFromItsNeighbours) {
  const RowOrder order = row_order(with_stamp(minute_rows(12), 11, kNoStamp), kRate);
  EXPECT_DOUBLE_EQ(order.time_s[11], 660.0);
  ASSERT_THAT(order.notes, SizeIs(1));
  EXPECT_THAT(order.notes[0], HasSubstr("blank in 1 row:"));
}

TEST(RowOrder, ARowThatFindsRoomElsewhereWasMoved) {
  Table table = minute_rows(12);
  table.set_column("time_s", {0, 60, 120, 240, 300, 360, 420, 480, 540, 600, 660, 180});
  const RowOrder order = row_order(table, kRate);
  EXPECT_EQ(order.rows[3], 11U);
  EXPECT_THAT(order.notes, IsEmpty());
}

TEST(RowOrder, ShuffledRowsAreSortedSilently) {
  Table table = minute_rows(8);
  table.set_column("time_s", {420, 0, 360, 60, 300, 120, 240, 180});
  const RowOrder order = row_order(table, kRate);
  EXPECT_THAT(order.rows, ElementsAre(1, 3, 5, 7, 6, 4, 2, 0));
  EXPECT_THAT(order.notes, IsEmpty());
}

TEST(RowOrder, RunsComeByNameAndRowsWrittenTwiceCountOnce) {
  Table table;
  table.set_column("time_s", {0, 60, 0, 60, 60});
  table.set_column(kRate, {1, 2, 3, 4, 2});
  table.set_run({{"10", "2"}, {0, 0, 1, 1, 0}});
  const RowOrder order = row_order(table, kRate);
  EXPECT_THAT(order.rows, ElementsAre(2, 3, 0, 1));
  EXPECT_THAT(order.notes, IsEmpty());
}

TEST(RowOrder, AClockThatStandsStillIsNoClock) {
  Table table = minute_rows(8);
  table.set_column("time_s", std::vector<double>(8, 5.0));
  EXPECT_FALSE(row_order(table, kRate).time_advances);
}

TEST(RowOrder, MendedStampsStandInTheTable) {
  Table table = with_stamp(minute_rows(12), 5, 240.0);
  EXPECT_THAT(mend_stamps(table, kRate), SizeIs(1));
  EXPECT_DOUBLE_EQ(table.column("time_s")[5], 300.0);
  EXPECT_THAT(mend_stamps(table, kRate), IsEmpty());
}

}  // namespace
}  // namespace fogbench::model
