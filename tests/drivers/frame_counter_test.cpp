#include "drivers/frame_counter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>

namespace fogbench::drivers {
namespace {

/// A gyro at 1 kHz whose frames each carry the true index as their rate, read now and then.
class FrameCounterTest : public testing::Test {
 protected:
  /// Frames first ... last arrive.
  void receive(std::int64_t first, std::int64_t last, std::int64_t skipped = 0) {
    for (std::int64_t i = first; i <= last; ++i) {
      const auto sequence = static_cast<std::uint32_t>((i + 90) % 128);
      block_.index.push_back(counter_.advance(sequence, i == first ? skipped : 0, entries_++));
      block_.rate_deg_per_h.push_back(static_cast<float>(i));
    }
  }
  void settle_at(double seconds, std::int64_t periods_since = 0) {
    counter_.settle(Clock::Instant{from_seconds(seconds)}, periods_since, entries_, block_,
                    statistics_);
    entries_ = 0;
  }
  /// Each index that came out, against the true one.
  void expect_aligned() const {
    for (std::size_t i = 0; i < block_.index.size(); ++i) {
      ASSERT_EQ(block_.index[i], static_cast<std::int64_t>(block_.rate_deg_per_h[i]));
    }
  }

  FrameCounter counter_{128, 1000.0};
  GyroBlock block_;
  StreamStatistics statistics_;
  std::size_t entries_ = 0;
};

TEST_F(FrameCounterTest, ASilenceOfExactlySomeTurnsIsNotInvisible) {
  for (const std::int64_t turns : {1, 2, 7, 100}) {
    FrameCounter fresh{128, 1000.0};
    std::swap(counter_, fresh);
    block_.clear();
    const std::int64_t lost = turns * 128;
    receive(0, 99);
    settle_at(0.1);
    settle_at(0.1 + static_cast<double>(lost) * 0.001);  // nothing came
    receive(100 + lost, 199 + lost);
    settle_at(0.2 + static_cast<double>(lost) * 0.001);
    expect_aligned();
    EXPECT_EQ(block_.index.size(), 200u);
    EXPECT_EQ(statistics_.frames_missing, static_cast<std::uint64_t>(lost));
    statistics_ = {};
  }
}

TEST_F(FrameCounterTest, AnySilenceOfAnyLengthKeepsIndexAndTimeTogether) {
  for (std::int64_t lost = 1; lost < 700; ++lost) {
    FrameCounter fresh{128, 1000.0};
    std::swap(counter_, fresh);
    block_.clear();
    receive(0, 49);
    settle_at(0.05);
    for (double t = 0.1; t < 0.05 + 0.001 * static_cast<double>(lost); t += 0.05) settle_at(t);
    receive(50 + lost, 99 + lost);
    settle_at(0.1 + 0.001 * static_cast<double>(lost));
    expect_aligned();
    ASSERT_EQ(block_.index.size(), 100u) << lost;
  }
}

TEST_F(FrameCounterTest, ALineThatFallsSilentWithinAReadDoesNotMoveItsLastFrames) {
  receive(0, 999);
  settle_at(1.0);
  receive(1000, 1299);  // then silence until 5.5 s
  for (const double t : {2.0, 3.0, 4.0, 5.0}) settle_at(t);
  receive(5500, 5999);
  settle_at(6.0);
  expect_aligned();
  EXPECT_EQ(block_.index.size(), 1800u);
}

TEST_F(FrameCounterTest, ASilenceInsideOneReadIsPutAtItsJump) {
  receive(0, 999);
  settle_at(1.0);
  receive(1000, 1299);
  receive(1500, 1999);
  settle_at(2.0);
  expect_aligned();
}

TEST_F(FrameCounterTest, AWholeTurnLostInsideOneReadShowsInTheNext) {
  receive(0, 999);
  settle_at(1.0);
  receive(1000, 1299);
  receive(1428, 1999);  // 128 lost: no jump to be seen
  settle_at(2.0);
  receive(2000, 2999);
  settle_at(3.0);
  EXPECT_EQ(block_.index.back(), 2999);
  EXPECT_EQ(statistics_.frames_missing, 128u);
}

TEST_F(FrameCounterTest, FramesThatAreOnlyLateAreNotLost) {
  receive(0, 999);
  settle_at(1.0);
  receive(1000, 1919);  // the machine is busy: the others wait somewhere
  settle_at(2.0);
  receive(1920, 2919);
  EXPECT_TRUE(counter_.misses_turns(Clock::Instant{from_seconds(3.0)}, 0));
  receive(2920, 3004);
  EXPECT_FALSE(counter_.misses_turns(Clock::Instant{from_seconds(3.005)}, 0));
  receive(3005, 3010);
  settle_at(3.2);  // late again, but what was seen a moment ago holds
  expect_aligned();
  EXPECT_EQ(statistics_.frames_missing, 0u);
}

TEST_F(FrameCounterTest, WhatIsStillMissingWhenFramesGoOnIsLost) {
  receive(0, 999);
  settle_at(1.0);
  settle_at(1.512);  // four turns
  receive(1512, 1999);
  EXPECT_TRUE(counter_.misses_turns(Clock::Instant{from_seconds(2.0)}, 0));
  receive(2000, 2399);
  EXPECT_TRUE(counter_.misses_turns(Clock::Instant{from_seconds(2.47)}, 0));
  settle_at(2.47);  // 70 late: the least that was missing counts
  expect_aligned();
  EXPECT_EQ(statistics_.frames_missing, 512u);
}

TEST_F(FrameCounterTest, DamagedFramesAreNoSilence) {
  receive(0, 999);
  settle_at(1.0);
  receive(1300, 1999, 300);  // the bytes of 300 frames were thrown away: two turns and 44
  settle_at(2.0);
  expect_aligned();
}

TEST_F(FrameCounterTest, DamagedFramesAtTheEndOfAReadAreNoSilence) {
  receive(0, 999);
  settle_at(1.0);
  receive(1000, 1499);
  settle_at(2.0, 500);
  receive(2000, 2999, 500);
  settle_at(3.0);
  expect_aligned();
}

TEST_F(FrameCounterTest, FramesThatCameBeforeAreRepeatsNotAnotherTurn) {
  receive(0, 999);
  settle_at(1.0);
  receive(1000, 1499);
  receive(1400, 1999);  // a hundred of them again
  settle_at(2.0);
  receive(2000, 2999);
  settle_at(3.0);
  expect_aligned();
  EXPECT_EQ(block_.index.size(), 3000u);
  EXPECT_EQ(statistics_.frames_repeated, 100u);
  EXPECT_EQ(statistics_.frames_missing, 0u);
}

TEST_F(FrameCounterTest, RepeatsThatGoOnInTheNextReadAreRepeatsToo) {
  receive(0, 999);
  settle_at(1.0);
  receive(1000, 1499);
  receive(1400, 1449);
  settle_at(1.5);
  receive(1450, 1999);
  settle_at(2.0);
  expect_aligned();
  EXPECT_EQ(block_.index.size(), 2000u);
  EXPECT_EQ(statistics_.frames_repeated, 100u);
  EXPECT_EQ(statistics_.frames_missing, 0u);
}

TEST_F(FrameCounterTest, AStuckSequenceNumberYieldsNothingHoweverLongItLasts) {
  receive(0, 999);
  settle_at(1.0);
  for (int second = 2; second <= 5; ++second) {
    for (int i = 0; i < 1000; ++i) receive(999, 999);
    settle_at(second);
  }
  for (int i = 0; i < 500; ++i) receive(999, 999);
  receive(5500, 5999);
  settle_at(6.0);
  expect_aligned();
  EXPECT_EQ(block_.index.size(), 1500u);
  EXPECT_EQ(statistics_.frames_repeated, 4500u);
  EXPECT_EQ(statistics_.frames_missing, 4500u);
}

TEST_F(FrameCounterTest, WhateverTheLineDoesTheIndexOnlyRises) {
  std::mt19937_64 random(11);
  const auto below = [&](std::uint64_t limit) {
    return static_cast<std::int64_t>(random() % limit);
  };
  receive(0, 0);
  std::int64_t next = 1;
  double now_s = 0.001;
  for (int read = 0; read < 3000; ++read) {
    for (std::int64_t part = below(4); part > 0; --part) {
      if (below(5) == 0) next = std::max<std::int64_t>(0, next + below(600) - 300);
      const std::int64_t count = below(200);
      receive(next, next + count, below(3) == 0 ? below(300) : 0);
      next += count + 1;
    }
    now_s += 0.001 * static_cast<double>(below(700));
    settle_at(now_s, below(10));
    ASSERT_EQ(statistics_.frames_good, block_.index.size());
    ASSERT_LE(block_.index.size(), static_cast<std::size_t>(block_.index.back() + 1));
    ASSERT_GE(statistics_.frames_good + statistics_.frames_missing,
              static_cast<std::uint64_t>(block_.index.back() + 1));
  }
  EXPECT_TRUE(std::adjacent_find(block_.index.begin(), block_.index.end(),
                                 std::greater_equal<>()) == block_.index.end());
}

TEST_F(FrameCounterTest, JitterAndASlowOscillatorDoNotMoveTheIndex) {
  // 100 ppm slow and 30 ms late at random, for an hour: 360 periods of drift in all.
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> late(0.0, 0.03);
  std::int64_t next = 0;
  for (int second = 1; second <= 3600; ++second) {
    const auto arrived = static_cast<std::int64_t>(second * 1000.0 * (1.0 - 1e-4));
    receive(next, arrived - 1);
    next = arrived;
    settle_at(second + late(random));
  }
  expect_aligned();
  EXPECT_EQ(statistics_.frames_missing, 0u);
}

TEST_F(FrameCounterTest, AFastOscillatorDoesNotMoveTheIndexEither) {
  std::int64_t next = 0;
  for (int second = 1; second <= 3600; ++second) {
    const auto arrived = static_cast<std::int64_t>(second * 1000.0 * (1.0 + 1e-3));
    receive(next, arrived - 1);
    next = arrived;
    settle_at(second);
  }
  expect_aligned();
  EXPECT_EQ(statistics_.frames_repeated, 0u);
}

}  // namespace
}  // namespace fogbench::drivers
