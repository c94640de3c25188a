#include "model/table/table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace fogbench::model {
namespace {

using testing::ElementsAre;

TEST(Table, SelectKeepsRowsInTheirOrder) {
  Table table;
  table.set_column("x", {1, 2, 3});
  table.set_run({{"a", "b"}, {0, 1, 0}});
  const Table part = table.select({true, false, true});
  EXPECT_EQ(part.rows(), 2u);
  EXPECT_THAT(std::vector<double>(part.column("x").begin(), part.column("x").end()),
              ElementsAre(1, 3));
  EXPECT_EQ(part.run().at(1), "a");
}

TEST(Table, AppendFillsWhatOneSideLacksWithMissing) {
  Table a, b;
  a.set_column("x", {1});
  a.set_run({{"one"}, {0}});
  b.set_column("y", {2, 3});
  b.set_run({{"two", "one"}, {0, 1}});
  a.append(b);
  EXPECT_EQ(a.rows(), 3u);
  EXPECT_TRUE(std::isnan(a.column("y")[0]));
  EXPECT_TRUE(std::isnan(a.column("x")[2]));
  EXPECT_EQ(a.column("y")[2], 3.0);
  EXPECT_EQ(a.run().at(1), "two");
  EXPECT_EQ(a.run().at(2), "one");
  Table empty;
  empty.append(a);
  EXPECT_EQ(empty.rows(), 3u);
}

}  // namespace
}  // namespace fogbench::model
