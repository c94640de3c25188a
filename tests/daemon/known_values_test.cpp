#include "daemon/known_values.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace fogbench::daemon {
namespace {

TEST(KnownValues, KeepWhatWasReadLastOfWhatIsMissing) {
  constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
  KnownValues known;
  procedures::MonitorRow row;
  row.azimuth_deg = 45.0;
  row.current_vertical_a = kMissing;
  EXPECT_TRUE(known.missing(row).empty()) << "it was never there";
  row.time_s = 10.0;
  row.current_vertical_a = 1.5;
  EXPECT_TRUE(known.missing(row).empty());
  row.time_s = 20.0;
  row.current_vertical_a = kMissing;
  for (int i = 0; i < 2; ++i) {
    const auto missing = known.missing(row);
    ASSERT_EQ(missing.size(), 1U);
    EXPECT_EQ(missing[0].name, "current_vertical_a");
    EXPECT_EQ(missing[0].value, 1.5);
    EXPECT_EQ(missing[0].time_s, 10.0);
    row.time_s = 30.0;
  }
}

}  // namespace
}  // namespace fogbench::daemon
