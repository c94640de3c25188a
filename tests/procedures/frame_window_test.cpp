#include "procedures/frame_window.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

namespace fogbench::procedures {
namespace {

/// Frames from ... to - 1, one after the other; the rate is the index.
drivers::GyroBlock frames(std::int64_t from, std::int64_t to) {
  drivers::GyroBlock block;
  for (std::int64_t i = from; i < to; ++i) {
    block.index.push_back(i);
    block.rate_deg_per_h.push_back(static_cast<float>(i));
  }
  return block;
}

drivers::GyroBlock without(drivers::GyroBlock block, std::int64_t from, std::int64_t to) {
  drivers::GyroBlock kept;
  for (std::size_t i = 0; i < block.index.size(); ++i) {
    if (block.index[i] >= from && block.index[i] < to) continue;
    kept.index.push_back(block.index[i]);
    kept.rate_deg_per_h.push_back(block.rate_deg_per_h[i]);
  }
  return kept;
}

TEST(FrameWindow, AveragesItsOwnFramesAndNoOther) {
  FrameWindow window(100, 11, 2);
  window.add(frames(90, 105));
  EXPECT_FALSE(window.complete());
  window.add(frames(105, 130));
  ASSERT_TRUE(window.complete());
  EXPECT_EQ(window.count(), 11U);
  EXPECT_EQ(window.dropped(), 0U);
  EXPECT_DOUBLE_EQ(window.mean(), 105.0);
  EXPECT_DOUBLE_EQ(window.standard_deviation(), std::sqrt(11.0));
}

TEST(FrameWindow, IsCompleteWithItsLastFrame) {
  FrameWindow window(0, 10, 2);
  window.add(frames(0, 9));
  EXPECT_FALSE(window.complete());
  window.add(frames(9, 10));
  EXPECT_TRUE(window.complete());
}

TEST(FrameWindow, CountsLostFramesAndSurvivesShortLosses) {
  FrameWindow window(0, 100, 5);
  window.add(without(frames(0, 100), 20, 25));
  ASSERT_TRUE(window.complete());
  EXPECT_EQ(window.count(), 95U);
  EXPECT_EQ(window.dropped(), 5U);
  EXPECT_EQ(window.worst_loss(), 5);
  EXPECT_FALSE(window.has_gap());
}

TEST(FrameWindow, ALossTooLongIsAGapWhereverItLies) {
  const auto has_gap = [](std::int64_t from, std::int64_t to) {
    FrameWindow window(0, 100, 5);
    window.add(without(frames(0, 120), from, to));
    EXPECT_TRUE(window.complete());
    return window.has_gap();
  };
  EXPECT_TRUE(has_gap(20, 26));
  EXPECT_TRUE(has_gap(0, 6));
  EXPECT_TRUE(has_gap(94, 101));
  EXPECT_TRUE(has_gap(0, 110)) << "nothing came";
  EXPECT_FALSE(has_gap(97, 115)) << "three frames of the window, the rest is after it";
}

TEST(FrameWindow, SeesAGapBetweenBlocks) {
  FrameWindow window(0, 100, 5);
  window.add(frames(0, 40));
  window.add(frames(46, 100));
  EXPECT_TRUE(window.has_gap());
  EXPECT_EQ(window.dropped(), 6U);
}

TEST(FrameWindow, StaysExactOverMillionsOfFramesOnALargeOffset) {
  FrameWindow window(0, 10'000'000, 0);
  drivers::GyroBlock block;
  for (std::int64_t begin = 0; begin < 10'000'000; begin += 1000) {
    block.clear();
    for (std::int64_t i = begin; i < begin + 1000; ++i) {
      block.index.push_back(i);
      block.rate_deg_per_h.push_back(i % 2 == 0 ? 54000.0F : 54000.5F);
    }
    window.add(block);
  }
  EXPECT_NEAR(window.mean(), 54000.25, 1e-9);
  EXPECT_NEAR(window.standard_deviation(), 0.25, 1e-7);
}

TEST(FrameWindow, WithoutFramesHasNoMean) {
  const FrameWindow window(0, 10, 2);
  EXPECT_TRUE(std::isnan(window.mean()));
  EXPECT_TRUE(std::isnan(window.standard_deviation()));
}

}  // namespace
}  // namespace fogbench::procedures
