#include "drivers/frame_rate_meter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace fogbench::drivers {
namespace {

/// A gyro of `rate` frames a second that is looked at now and then.
class FrameRateMeterTest : public testing::Test {
 protected:
  /// Looks every `every_s` for `for_s`; frames come up to `late_s` late.
  void watch(FrameRateMeter& meter, double rate_hz, double for_s, double every_s,
             double late_s = 0.0) {
    std::uniform_real_distribution<double> late(0.0, late_s);
    for (const double end_s = now_s_ + for_s; now_s_ < end_s; now_s_ += every_s) {
      sent_ += rate_hz * every_s;
      const double arrived = std::max(arrived_, sent_ - rate_hz * late(random_));
      arrived_ = arrived;
      meter.look(Clock::Instant{from_seconds(now_s_)},
                 counted_from_ + static_cast<std::int64_t>(std::floor(arrived)));
    }
  }

  double now_s_ = 100.0;
  double sent_ = 0.0;
  double arrived_ = 0.0;
  std::int64_t counted_from_ = 0;
  std::mt19937_64 random_{7};
};

TEST_F(FrameRateMeterTest, KnowsNothingBeforeEightSeconds) {
  FrameRateMeter meter(1000.0);
  watch(meter, 1000.0, 7.5, 0.005);
  EXPECT_FALSE(meter.rate());
  watch(meter, 1000.0, 1.0, 0.005);
  ASSERT_TRUE(meter.rate());
  EXPECT_TRUE(meter.rate()->as_stated);
  EXPECT_NEAR(meter.rate()->measured_hz, 1000.0, 0.5);
}

TEST_F(FrameRateMeterTest, SeesAnotherRateWithinNineSecondsAndSaysHowMuch) {
  for (const double rate_hz : {500.0, 900.0, 995.0, 1005.0, 1010.0, 2000.0}) {
    FrameRateMeter meter(1000.0);
    watch(meter, rate_hz, 9.0, 0.005, 0.016);  // a USB adapter's latency
    ASSERT_TRUE(meter.rate()) << rate_hz;
    EXPECT_FALSE(meter.rate()->as_stated) << rate_hz;
    EXPECT_NEAR(meter.rate()->measured_hz, rate_hz, 0.001 * rate_hz);
  }
}

TEST_F(FrameRateMeterTest, AnOscillatorAThousandthOffIsAsStatedHoweverLateItsFramesCome) {
  for (const double rate_hz : {999.0, 1000.0, 1001.0}) {
    FrameRateMeter meter(1000.0);
    for (int second = 0; second < 300; ++second) {
      watch(meter, rate_hz, 1.0, 0.005, 0.05);
      if (meter.rate()) {
        ASSERT_TRUE(meter.rate()->as_stated) << rate_hz << " at " << second;
      }
    }
  }
}

TEST_F(FrameRateMeterTest, TurnsLostForGoodAreNoLowRate) {
  FrameRateMeter meter(1000.0);
  for (int second = 0; second < 60; ++second) {
    watch(meter, 1000.0, 1.0, 0.005);
    if (second % 7 == 0) sent_ -= 128.0;  // came, but nobody can tell
    if (meter.rate()) {
      ASSERT_TRUE(meter.rate()->as_stated) << second;
    }
  }
}

TEST_F(FrameRateMeterTest, AStallAndTheBurstAfterItAreNoOtherRate) {
  FrameRateMeter meter(1000.0);
  for (int second = 0; second < 60; ++second) {
    watch(meter, 1000.0, 1.0, 0.005);
    if (second % 8 == 7) {  // nothing for 2.5 s, then all at once
      sent_ += 2500.0;
      now_s_ += 2.5;
    }
    if (meter.rate()) {
      ASSERT_TRUE(meter.rate()->as_stated) << second;
    }
  }
}

TEST_F(FrameRateMeterTest, LooksOnceASecondTakeLongerAndAreAsSure) {
  FrameRateMeter right(100.0);
  watch(right, 100.0, 1200.0, 1.0, 0.016);
  ASSERT_TRUE(right.rate());
  EXPECT_TRUE(right.rate()->as_stated);
  FrameRateMeter wrong(100.0);
  watch(wrong, 100.5, 190.0, 1.0, 0.016);
  ASSERT_TRUE(wrong.rate());
  EXPECT_FALSE(wrong.rate()->as_stated);
  EXPECT_NEAR(wrong.rate()->measured_hz, 100.5, 0.1);
}

TEST_F(FrameRateMeterTest, LatenessByChanceIsNoOtherRateHoweverLarge) {
  for (const double late_s : {0.003, 0.03, 0.3}) {
    for (int trial = 0; trial < 200; ++trial) {
      FrameRateMeter meter(100.0);
      // A look each 50 ms: twenty make a span, and each span's least is as late as chance has it.
      std::exponential_distribution<double> late(1.0 / late_s);
      double least_s = 0.0;
      for (int look = 0; look < 400; ++look) {
        if (look % 20 == 0) least_s = late(random_);
        meter.look(Clock::Instant{from_seconds(100.0 + 0.0501 * look)},
                   static_cast<std::int64_t>(1e6 + 5.01 * look - 100.0 * least_s));
        if (const auto rate = meter.rate()) {
          ASSERT_TRUE(rate->as_stated) << late_s << " " << trial;
        }
      }
    }
  }
}

TEST_F(FrameRateMeterTest, ARateThatChangesIsSeenAndSoIsItsReturn) {
  FrameRateMeter meter(1000.0);
  watch(meter, 1000.0, 10.0, 0.005);
  EXPECT_TRUE(meter.rate()->as_stated);
  watch(meter, 1010.0, 9.0, 0.005);
  ASSERT_TRUE(meter.rate());
  EXPECT_FALSE(meter.rate()->as_stated);
  watch(meter, 1000.0, 9.0, 0.005);
  ASSERT_TRUE(meter.rate());
  EXPECT_TRUE(meter.rate()->as_stated);
}

TEST_F(FrameRateMeterTest, ASilentLineKeepsWhatWasMeasured) {
  FrameRateMeter meter(1000.0);
  watch(meter, 1000.0, 9.0, 0.005);
  watch(meter, 0.0, 100.0, 0.005);
  ASSERT_TRUE(meter.rate());
  EXPECT_TRUE(meter.rate()->as_stated);
}

}  // namespace
}  // namespace fogbench::drivers
