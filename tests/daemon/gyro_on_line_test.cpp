// Which gyro is on the line, and since when: heard from a scripted line on a virtual clock.

#include "daemon/gyro_on_line.hpp"

#include <gmock/gmock.h>

namespace fogbench::daemon {
namespace {

using namespace std::chrono_literals;
using drivers::Clock;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Sends 100 frames a second while it is on.
class ScriptedGyro final : public drivers::Gyro {
 public:
  Result<std::string> identity() override { return std::string("scripted"); }
  Status begin_anew(Clock::Instant switched_on) override {
    begun_anew.push_back(drivers::to_seconds(switched_on.time_since_epoch()));
    return {};
  }
  Status read(drivers::GyroBlock& out) override {
    if (!on) return Error{ErrorCode::kTimeout, "silent"};
    out.index.push_back(++frames_);
    return {};
  }
  const drivers::StreamStatistics& statistics() const override { return statistics_; }
  Clock::Instant time_of(std::int64_t) const override { return {}; }
  double frame_rate_hz() const override { return 100.0; }
  std::optional<drivers::FrameRate> measured_frame_rate() const override { return {}; }

  bool on = true;
  std::vector<double> begun_anew;  ///< since when, each time

 private:
  std::int64_t frames_ = 0;
  drivers::StreamStatistics statistics_;
};

class GyroOnLineTest : public testing::Test {
 protected:
  /// Listens twice a second; what was said.
  std::vector<std::string> listen(std::chrono::seconds span) {
    std::vector<std::string> said;
    for (const auto end = clock_.now() + span; clock_.now() < end;) {
      clock_.sleep_for(500ms);
      if (std::string one = line_.listen(); !one.empty()) said.push_back(one);
    }
    return said;
  }
  GyroOnLine::Taken take(const std::string& gyro, const std::optional<SwitchedOn>& said = {},
                         bool exchanged = false) {
    const auto taken = line_.take(gyro, said, exchanged);
    EXPECT_TRUE(taken) << taken.error().message;
    return *taken;
  }

  drivers::VirtualClock clock_;
  ScriptedGyro gyro_;
  GyroOnLine line_{gyro_, clock_};
};

TEST_F(GyroOnLineTest, TheSameGyroThatStayedOnGoesOn) {
  EXPECT_THAT(take("A").remarks, IsEmpty());
  EXPECT_THAT(listen(60s), IsEmpty());
  EXPECT_THAT(take("A").remarks, IsEmpty());
  EXPECT_THAT(take("").remarks, IsEmpty()) << "nobody says that it is another";
  EXPECT_THAT(gyro_.begun_anew, IsEmpty());
}

TEST_F(GyroOnLineTest, ASilenceIsHowItIsKnownThatAGyroWasSwitchedOff) {
  take("A");
  gyro_.on = false;
  EXPECT_THAT(listen(30s), ElementsAre("gyro: silent, as one that is switched off"));
  gyro_.on = true;
  EXPECT_THAT(listen(20s), ElementsAre("gyro: heard again after 31 s"));
  const auto taken = take("B");
  EXPECT_FALSE(taken.doubtful);
  ASSERT_EQ(gyro_.begun_anew.size(), 1U);
  EXPECT_NEAR(gyro_.begun_anew[0], 30.5, 0.6);
  EXPECT_THAT(taken.remarks,
              ElementsAre(HasSubstr("operating time of gyro B counts from 2026-01-01T00:00:30Z, "
                                    "when its stream came after a silence of 31 s")));
  EXPECT_THAT(take("B").remarks, IsEmpty()) << "it counts once";
}

TEST_F(GyroOnLineTest, AnotherGyroOnALineThatNeverFellSilentIsDoubted) {
  take("A");
  listen(60s);
  const auto taken = take("B");
  EXPECT_TRUE(taken.doubtful);
  EXPECT_EQ(taken.before, "A");
  EXPECT_THAT(gyro_.begun_anew, ElementsAre(testing::DoubleNear(60.0, 0.1)));
  EXPECT_FALSE(take("A", {}, true).doubtful) << "it was exchanged on purpose";
}

TEST_F(GyroOnLineTest, WhoKnowsSinceWhenItIsOnIsBelieved) {
  clock_.sleep_for(3600s);
  const double now_s = drivers::to_seconds(clock_.wall_now().time_since_epoch());
  const auto taken = take("A", SwitchedOn{now_s - 7200.0, "alice"});
  EXPECT_THAT(gyro_.begun_anew, ElementsAre(testing::DoubleNear(-3600.0, 0.1)));
  EXPECT_THAT(taken.remarks, ElementsAre(testing::EndsWith("2025-12-31T23:00:00Z, as alice says")));
}

}  // namespace
}  // namespace fogbench::daemon
