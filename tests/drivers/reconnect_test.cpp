#include "drivers/reconnect.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace fogbench::drivers {
namespace {

using namespace std::chrono_literals;

struct Line {
  int number;
};

class ReconnectTest : public testing::Test {
 protected:
  VirtualClock clock_;
  bool there_ = true;
  int opened_ = 0;
  std::vector<Clock::Instant> tries_;
  Reconnecting<Line> line_{clock_, [this]() -> Result<std::unique_ptr<Line>> {
                             tries_.push_back(clock_.now());
                             if (!there_) return Error{ErrorCode::kTimeout, "nobody there"};
                             return std::make_unique<Line>(Line{++opened_});
                           }};
};

TEST_F(ReconnectTest, OpensOnceAndKeepsTheLine) {
  for (int i = 0; i < 3; ++i) {
    const auto line = line_.get();
    ASSERT_TRUE(line);
    EXPECT_EQ((*line)->number, 1);
  }
  EXPECT_EQ(tries_.size(), 1U);
}

TEST_F(ReconnectTest, SaysWhenAnotherHasItNow) {
  Reconnecting<Line> held(clock_, []() -> Result<std::unique_ptr<Line>> {
    return Error{ErrorCode::kHeld, "held by process 7"};
  });
  EXPECT_EQ(held.get().error().code, ErrorCode::kHeld);
  EXPECT_EQ(held.get().error().code, ErrorCode::kHeld) << "between two tries, too";
}

TEST_F(ReconnectTest, ReopensAtOnceWhatWasLost) {
  ASSERT_TRUE(line_.get());
  line_.lost();
  const auto line = line_.get();
  ASSERT_TRUE(line);
  EXPECT_EQ((*line)->number, 2);
}

TEST_F(ReconnectTest, TriesLessAndLessOftenButEverySecond) {
  there_ = false;
  while (clock_.now().time_since_epoch() < 6s) {
    const auto line = line_.get();
    ASSERT_FALSE(line);
    EXPECT_EQ(line.error().code, ErrorCode::kUnplugged);
    EXPECT_EQ(line.error().message, "nobody there");
    clock_.sleep_for(10ms);
  }
  ASSERT_GE(tries_.size(), 8U);
  const Clock::Duration expected[] = {100ms, 200ms, 400ms, 800ms, 1s, 1s, 1s};
  for (std::size_t i = 0; i < std::size(expected); ++i) {
    EXPECT_EQ(tries_[i + 1] - tries_[i], expected[i]) << i;
  }
}

TEST_F(ReconnectTest, AReturnBeginsTheBackOffAnew) {
  there_ = false;
  for (int i = 0; i < 50; ++i) {
    EXPECT_FALSE(line_.get());
    clock_.sleep_for(100ms);
  }
  there_ = true;
  clock_.sleep_for(1s);
  ASSERT_TRUE(line_.get());
  line_.lost();
  there_ = false;
  tries_.clear();
  EXPECT_FALSE(line_.get());
  clock_.sleep_for(100ms);
  there_ = true;
  EXPECT_TRUE(line_.get());
  EXPECT_EQ(tries_.size(), 2U);
}

}  // namespace
}  // namespace fogbench::drivers
