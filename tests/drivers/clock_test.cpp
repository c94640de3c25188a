#include "drivers/clock.hpp"

#include <gtest/gtest.h>

namespace fogbench::drivers {
namespace {

using namespace std::chrono_literals;

TEST(VirtualClock, MovesOnlyBySleepingAndNeverBack) {
  VirtualClock clock;
  EXPECT_EQ(clock.now().time_since_epoch(), 0ns);
  clock.sleep_for(8h);
  EXPECT_EQ(clock.now().time_since_epoch(), 8h);
  clock.sleep_until(Clock::Instant{1h});
  EXPECT_EQ(clock.now().time_since_epoch(), 8h);
}

TEST(VirtualClock, WallTimeFollowsTheSteadyTime) {
  VirtualClock clock;
  const auto before = clock.wall_now();
  clock.sleep_for(1500ms);
  EXPECT_EQ(clock.wall_now() - before, 1500ms);
}

TEST(SteadyClock, RunsFasterByItsSpeed) {
  SteadyClock clock(100.0);
  const auto before = clock.now();
  clock.sleep_for(1s);
  EXPECT_GE(clock.now() - before, 1s);
}

}  // namespace
}  // namespace fogbench::drivers
