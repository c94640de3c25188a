#include "drivers/patience.hpp"

#include <gtest/gtest.h>

namespace fogbench::drivers {
namespace {

using namespace std::chrono_literals;

class PatienceTest : public testing::Test {
 protected:
  /// A question that fails so often with this error, then is answered.
  auto question(int failures, ErrorCode code) {
    return [this, left = failures, code]() mutable -> Status {
      ++asked_;
      if (left-- > 0) return Error{code, "why"};
      return {};
    };
  }
  VirtualClock clock_;
  const Clock::Instant begun_ = clock_.now();
  int asked_ = 0;
};

TEST_F(PatienceTest, ABusyOneIsAskedAgainWithAPauseUntilTheTimeIsOver) {
  const Patience second(clock_, 1s);
  EXPECT_TRUE(ask_again(second, question(5, ErrorCode::kBusy)));
  EXPECT_EQ(clock_.now() - begun_, 500ms);
  const Status given_up = ask_while_busy(second, question(1000, ErrorCode::kBusy));
  ASSERT_FALSE(given_up);
  EXPECT_EQ(given_up.error().code, ErrorCode::kBusy);
  EXPECT_EQ(given_up.error().message, "why, for 1.0 s");
  EXPECT_EQ(clock_.now() - begun_, 1s) << "of both questions together";
}

TEST_F(PatienceTest, WhatIsLostIsPutThreeTimesForEachQuestion) {
  const Patience second(clock_, 1s);
  for (const ErrorCode lost : {ErrorCode::kTimeout, ErrorCode::kProtocol, ErrorCode::kUnplugged}) {
    EXPECT_TRUE(ask_again(second, question(2, lost)));
    asked_ = 0;
    EXPECT_EQ(ask_again(second, question(3, lost)).error().message, "why");
    EXPECT_EQ(asked_, 3);
  }
  EXPECT_EQ(clock_.now(), begun_);
}

TEST_F(PatienceTest, WhatMayHaveBeenHeardIsNotSaidTwice) {
  EXPECT_FALSE(ask_while_busy(Patience(clock_, 1s), question(1, ErrorCode::kTimeout)));
  EXPECT_EQ(asked_, 1);
}

TEST_F(PatienceTest, ARefusalIsFinal) {
  for (const ErrorCode refusal : {ErrorCode::kDevice, ErrorCode::kLimit, ErrorCode::kHeld}) {
    asked_ = 0;
    EXPECT_FALSE(ask_again(Patience(clock_, 1s), question(1, refusal)));
    EXPECT_EQ(asked_, 1);
  }
}

}  // namespace
}  // namespace fogbench::drivers
