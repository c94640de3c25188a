#include "drivers/clock.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <ctime>
#include <limits>

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

TEST(UtcText, IsIso8601ToTheSecond) {
  VirtualClock clock;
  clock.sleep_for(26h + 3min + 4999ms);
  EXPECT_EQ(utc_text(clock.wall_now()), "2026-01-02T02:03:04Z");
}

TEST(UtcText, DoesNotKnowTheMachinesZone) {
  setenv("TZ", "AAA-5BBB,0/0,J365/25", 1);  // daylight saving all the year round
  tzset();
  const std::string text = utc_text(VirtualClock().wall_now());
  unsetenv("TZ");
  tzset();
  EXPECT_EQ(text, "2026-01-01T00:00:00Z");
}

TEST(VirtualClock, WallTimeFollowsTheSteadyTime) {
  VirtualClock clock;
  const auto before = clock.wall_now();
  clock.sleep_for(1500ms);
  EXPECT_EQ(clock.wall_now() - before, 1500ms);
}

TEST(FromSeconds, RoundsAndStaysInRangeWhateverAFileSays) {
  EXPECT_EQ(from_seconds(1.5), 1500ms);
  EXPECT_EQ(from_seconds(-0.25e-9), 0ns);
  EXPECT_EQ(from_seconds(1e300), 1'000'000'000s);
  EXPECT_EQ(from_seconds(-1e300), -1'000'000'000s);
  EXPECT_EQ(from_seconds(std::numeric_limits<double>::quiet_NaN()), 0s);
  VirtualClock clock;
  clock.sleep_for(from_seconds(1e300));
  EXPECT_GT(clock.now() + from_seconds(1e300), clock.now());
}

TEST(SteadyClock, RunsFasterByItsSpeed) {
  SteadyClock clock(100.0);
  const auto before = clock.now();
  clock.sleep_for(1s);
  EXPECT_GE(clock.now() - before, 1s);
}

TEST(SteadyClock, DatesFollowTheCalendarFromWhereItWasFollowedLast) {
  Clock::WallTime set = std::chrono::sys_days{std::chrono::year{2026} / std::chrono::January / 1};
  SteadyClock clock(1.0, [&set] { return set; });
  const auto before = clock.wall_now();
  EXPECT_LT(before - set, 1min);
  set += 240h;  // the steady clock is not told
  EXPECT_GT(clock.calendar_offset(), 239h);
  EXPECT_LT(clock.wall_now() - before, 1min) << "not before it is followed";
  clock.follow_calendar();
  EXPECT_LT(clock.wall_now() - set, 1min);
  EXPECT_LT(clock.calendar_offset(), 1min);
  set -= 1h;
  EXPECT_LT(clock.calendar_offset(), -59min);
  EXPECT_LT(clock.now().time_since_epoch(), 1min) << "no duration sees any of this";
}

TEST(SteadyClock, ACalendarThatRunsFasterIsNotTheMachines) {
  Clock::WallTime set = std::chrono::sys_days{std::chrono::year{2026} / std::chrono::January / 1};
  SteadyClock clock(100.0, [&set] { return set; });
  set += 1h;
  EXPECT_EQ(clock.calendar_offset(), 0s);
  const auto before = clock.wall_now();
  clock.follow_calendar();
  EXPECT_LT(clock.wall_now() - before, 10min);
}

TEST(VirtualClock, FollowsACalendarThatWasSet) {
  VirtualClock clock;
  const auto before = clock.wall_now();
  clock.set_calendar(-1h);
  clock.set_calendar(-1h);
  EXPECT_EQ(clock.calendar_offset(), -2h);
  EXPECT_EQ(clock.wall_now(), before);
  clock.follow_calendar();
  EXPECT_EQ(clock.wall_now(), before - 2h);
  EXPECT_EQ(clock.calendar_offset(), 0s);
  EXPECT_EQ(clock.now().time_since_epoch(), 0ns);
}

}  // namespace
}  // namespace fogbench::drivers
