#include "drivers/serial_gyro.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/fake_transports.hpp"
#include "tests/support/kvh_frame.hpp"

namespace fogbench::drivers {
namespace {

using namespace std::chrono_literals;
using support::kvh_frame;

/// A gyro, at 1 kHz unless told otherwise, on a virtual clock: frame i is sent when i + 1 periods
/// have passed.
class SerialGyroTest : public testing::Test {
 protected:
  SerialGyroTest() {
    config_.device = support::kvh_device();
    line_.before_read = [this] { send_due_frames(); };
  }
  void send_due_frames() {
    const Clock::Instant now = clock_.now();
    const Clock::Instant due = now < late_until_ ? now - 80ms : now;
    for (; (sent_ + 1) * period_ <= due.time_since_epoch(); ++sent_) {
      if (!mute_) line_.put(kvh_frame(sent_, static_cast<double>(sent_)));
    }
  }
  Result<std::unique_ptr<SerialGyro>> open() {
    return begun(
        SerialGyro::attach("gyro", config_, std::make_unique<support::FakeSerial>(line_), clock_));
  }

  VirtualClock clock_;
  config::GyroConfig config_;
  support::FakeLine line_;
  Clock::Duration period_ = 1ms;
  std::int64_t sent_ = 0;
  bool mute_ = false;
  Clock::Instant late_until_{};  ///< until then frames come 80 ms late
};

TEST_F(SerialGyroTest, AnotherGyroIsCountedFromItsOwnPowerOn) {
  auto gyro = open();
  ASSERT_TRUE(gyro) << gyro.error().message;
  GyroBlock block;
  clock_.sleep_for(10s);
  ASSERT_TRUE((*gyro)->read(block));
  mute_ = true;
  clock_.sleep_for(20s);
  (void)(*gyro)->read(block);
  mute_ = false;
  const Clock::Instant power_on = clock_.now();
  clock_.sleep_for(20s);
  const auto before = (*gyro)->statistics();
  ASSERT_TRUE((*gyro)->begin_anew(power_on));
  EXPECT_NEAR(to_seconds((*gyro)->time_of(0) - power_on), 0.0, 2e-3);
  block.clear();
  clock_.sleep_for(1s);
  ASSERT_TRUE((*gyro)->read(block));
  EXPECT_NEAR(static_cast<double>(block.index.front()), 20000.0, 3.0);
  for (std::size_t i = 0; i < block.index.size(); ++i) {
    const double middle_s = (static_cast<double>(block.rate_deg_per_h[i]) + 0.5) * 1e-3;
    ASSERT_NEAR(to_seconds((*gyro)->time_of(block.index[i]).time_since_epoch()), middle_s, 0.5e-3);
  }
  const auto of_its_own = (*gyro)->statistics() - before;
  EXPECT_EQ(of_its_own.frames_good, block.index.size() + 1) << "and the first, which ties it";
  EXPECT_EQ(of_its_own.frames_missing, 0U);
}

TEST_F(SerialGyroTest, TiesIndexToTheClockAndKeepsItThere) {
  clock_.sleep_for(12345678us);  // frames of the past, thrown away
  auto gyro = open();
  ASSERT_TRUE(gyro) << gyro.error().message;
  GyroBlock block;
  for (int i = 0; i < 10; ++i) {
    clock_.sleep_for(333ms);
    ASSERT_TRUE((*gyro)->read(block));
  }
  ASSERT_GT(block.index.size(), 3300u);
  for (std::size_t i = 0; i < block.index.size(); ++i) {
    // Frame n is the sample from n to n + 1 ms; its middle is known to a quarter of a period.
    const double middle_s = (static_cast<double>(block.rate_deg_per_h[i]) + 0.5) * 1e-3;
    ASSERT_NEAR(to_seconds((*gyro)->time_of(block.index[i]).time_since_epoch()), middle_s, 0.27e-3);
  }
  EXPECT_EQ(*(*gyro)->identity(), "KVH 1750 layout");
  EXPECT_EQ((*gyro)->frame_rate_hz(), 1000.0);
  EXPECT_EQ((*gyro)->statistics().frames_missing, 0u);
}

TEST_F(SerialGyroTest, NothingNewAppendsNothing) {
  auto gyro = open();
  ASSERT_TRUE(gyro);
  GyroBlock block;
  ASSERT_TRUE((*gyro)->read(block));
  EXPECT_TRUE(block.index.empty());
}

TEST_F(SerialGyroTest, SilenceIsATimeoutAndTheIndexIsRightAfterwards) {
  auto gyro = open();
  ASSERT_TRUE(gyro);
  GyroBlock block;
  mute_ = true;
  clock_.sleep_for(900ms);
  EXPECT_TRUE((*gyro)->read(block));
  clock_.sleep_for(4220ms);  // 5120 ms in all: forty turns of the sequence number, exactly
  const Status silent = (*gyro)->read(block);
  ASSERT_FALSE(silent);
  EXPECT_EQ(silent.error().code, ErrorCode::kTimeout);
  EXPECT_EQ(silent.error().message, "gyro: no frame for 5.1 s, expected 1000 a second");
  mute_ = false;
  clock_.sleep_for(100ms);
  const Clock::Instant before = clock_.now();
  ASSERT_TRUE((*gyro)->read(block));
  EXPECT_EQ(clock_.now() - before, 500ms) << "in which they might have come";
  ASSERT_EQ(block.index.size(), 600u);
  EXPECT_EQ(block.index[0], 5121);  // frame 0 was received at opening
  EXPECT_NEAR(to_seconds((*gyro)->time_of(block.index.back()) - clock_.now()), -0.0005, 0.001);
  EXPECT_EQ((*gyro)->statistics().frames_missing, 5120u);
}

TEST_F(SerialGyroTest, FramesThatABusyMachineBringsLateAreNotLost) {
  auto gyro = open();
  ASSERT_TRUE(gyro);
  GyroBlock block;
  for (int i = 0; i < 3; ++i) {
    clock_.sleep_for(1s);
    const Clock::Instant before = clock_.now();
    late_until_ = before + 18ms;
    ASSERT_TRUE((*gyro)->read(block));
    // Once it might be the line falling silent, for which nothing is waited.
    EXPECT_EQ(clock_.now() - before, i == 1 ? 20ms : 0ms) << i;
  }
  ASSERT_GT(block.index.size(), 2900u);
  for (std::size_t i = 0; i < block.index.size(); ++i) {
    ASSERT_EQ(block.index[i], std::llround(block.rate_deg_per_h[i]));
  }
  EXPECT_EQ((*gyro)->statistics().frames_missing, 0u);
}

TEST_F(SerialGyroTest, BytesWithoutFramesAreAProtocolError) {
  auto gyro = open();
  ASSERT_TRUE(gyro);
  mute_ = true;
  line_.put(std::vector<std::uint8_t>(5000, 0x81));
  clock_.sleep_for(2s);
  GyroBlock block;
  const Status status = (*gyro)->read(block);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kProtocol);
  EXPECT_NE(status.error().message.find("gyro: 5000 bytes in 2.0 s but no good frame"),
            std::string::npos)
      << status.error().message;
}

TEST_F(SerialGyroTest, ASlowGyroIsNotSilentBetweenItsFrames) {
  period_ = 5s;
  config_.device.frame_rate_hz = 0.2;
  auto gyro = open();
  ASSERT_TRUE(gyro) << gyro.error().message;
  GyroBlock block;
  clock_.sleep_for(4s);
  EXPECT_TRUE((*gyro)->read(block));
  mute_ = true;
  clock_.sleep_for(51s);
  const Status silent = (*gyro)->read(block);
  ASSERT_FALSE(silent);
  EXPECT_EQ(silent.error().code, ErrorCode::kTimeout);
}

TEST_F(SerialGyroTest, ASilentLineCannotBeOpened) {
  mute_ = true;
  const auto gyro = open();
  ASSERT_FALSE(gyro);
  EXPECT_EQ(gyro.error().code, ErrorCode::kTimeout);
}

TEST_F(SerialGyroTest, ALayoutThatCannotBeIsRefusedBeforeAnythingIsRead) {
  config_.device.frame_bytes = 20;
  const auto gyro = open();
  ASSERT_FALSE(gyro);
  EXPECT_EQ(gyro.error().code, ErrorCode::kBadInput);
}

TEST_F(SerialGyroTest, AFailingLineIsReportedWithWhatHadArrived) {
  auto gyro = open();
  ASSERT_TRUE(gyro);
  clock_.sleep_for(10ms);
  line_.chunk = 36;
  int reads = 0;
  line_.before_read = [&] {
    send_due_frames();
    if (++reads == 4) line_.failure = Error{ErrorCode::kUnplugged, "unplugged"};
  };
  GyroBlock block;
  const Status status = (*gyro)->read(block);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kUnplugged);
  EXPECT_EQ(status.error().message, "gyro: unplugged");
  EXPECT_EQ(block.index.size(), 3u);
}

TEST_F(SerialGyroTest, TakesAllThatIsDueAfterALongAbsence) {
  auto gyro = open();
  ASSERT_TRUE(gyro);
  clock_.sleep_for(100s);  // 3.6 MB
  GyroBlock block;
  ASSERT_TRUE((*gyro)->read(block));
  EXPECT_EQ(block.index.size(), 100000u);
  EXPECT_NEAR(to_seconds((*gyro)->time_of(block.index.back()) - clock_.now()), -0.0005, 0.001);
}

TEST_F(SerialGyroTest, ALineThatNeverRunsEmptyDoesNotHoldTheCaller) {
  auto gyro = open();
  ASSERT_TRUE(gyro);
  line_.before_read = [&] {
    for (int i = 0; i < 200; ++i, ++sent_) line_.put(kvh_frame(sent_, 0.0));
  };
  GyroBlock block;
  EXPECT_TRUE((*gyro)->read(block));
  EXPECT_GT(block.index.size(), 29000u);  // a mebibyte
  EXPECT_LT(block.index.size(), 31000u);
}

}  // namespace
}  // namespace fogbench::drivers
