#include "drivers/deadline.hpp"

#include <gtest/gtest.h>

namespace fogbench::drivers {
namespace {

using namespace std::chrono_literals;

TEST(Deadline, ComesAfterItsTimeAndIsNeverNegative) {
  const Deadline deadline(20ms);
  EXPECT_FALSE(deadline.passed());
  EXPECT_GT(deadline.left_ms(), 0);
  EXPECT_LE(deadline.left_ms(), 20);
  SteadyClock().sleep_for(25ms);
  EXPECT_TRUE(deadline.passed());
  EXPECT_EQ(deadline.left_ms(), 0);
  EXPECT_EQ(deadline.left(), 0ns);
}

TEST(Deadline, LessThanAMillisecondIsStillWaitedFor) {
  EXPECT_LE(Deadline(500us).left_ms(), 1);
  EXPECT_EQ(Deadline(0ns).left_ms(), 0);
  EXPECT_EQ(Deadline(-1s).left_ms(), 0);
}

TEST(Deadline, NoTimeIsTooLongToCount) {
  EXPECT_EQ(Deadline(from_seconds(1e9)).left_ms(), 24 * 3600 * 1000);
}

}  // namespace
}  // namespace fogbench::drivers
