#include "drivers/line_messages.hpp"

#include <gtest/gtest.h>

#include "tests/support/fake_transports.hpp"

namespace fogbench::drivers {
namespace {

using support::FakeLine;
using support::FakeSerial;
using namespace std::chrono_literals;

class LineMessagesTest : public testing::Test {
 protected:
  void arrives(const std::string& text) {
    for (const char c : text) line_.bytes.push_back(static_cast<std::byte>(c));
  }
  FakeLine line_;
  VirtualClock clock_;
  LineMessages messages_{std::make_unique<FakeSerial>(line_), clock_};
};

TEST_F(LineMessagesTest, SendsALineAndReturnsTheAnswerWithoutItsEnd) {
  ASSERT_TRUE(messages_.write("POS?"));
  EXPECT_EQ(line_.written, "POS?\n");
  line_.chunk = 2;
  arrives("90.000\r\nnext");
  const auto answer = messages_.read(1s);
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_EQ(*answer, "90.000");
}

TEST_F(LineMessagesTest, WaitsForTheEndOfTheLine) {
  arrives("90.");
  line_.before_read = [this] {
    if (clock_.now().time_since_epoch() >= 100ms) arrives("5\n");
  };
  const auto answer = messages_.read(1s);
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_EQ(*answer, "90.5");
}

TEST_F(LineMessagesTest, HalfAnAnswerIsATimeOutAndForgotten) {
  arrives("90.");
  const auto answer = messages_.read(1s);
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, ErrorCode::kTimeout);
  EXPECT_EQ(clock_.now().time_since_epoch(), 1s);
  arrives("5\n");
  EXPECT_EQ(*messages_.read(1s), "5");
}

TEST_F(LineMessagesTest, ALateAnswerIsThrownAwayBeforeTheNextQuestion) {
  arrives("late\n");
  ASSERT_TRUE(messages_.write("MEAS:POS?"));
  arrives("right\n");
  EXPECT_EQ(*messages_.read(1s), "right");
}

TEST_F(LineMessagesTest, ClearingListensForALateAnswer) {
  bool sent = false;
  line_.before_read = [&] {
    if (!sent && clock_.now().time_since_epoch() >= 400ms) {
      sent = true;
      arrives("late\n");
    }
  };
  ASSERT_TRUE(messages_.clear());
  EXPECT_TRUE(sent);
  EXPECT_TRUE(line_.bytes.empty());
  EXPECT_EQ(line_.written, "\n");
  EXPECT_EQ(messages_.read(1s).error().code, ErrorCode::kTimeout);
}

TEST_F(LineMessagesTest, NoiseWithoutALineEndIsAnError) {
  arrives(std::string(5000, '~'));
  const auto answer = messages_.read(1s);
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, ErrorCode::kProtocol);
}

TEST_F(LineMessagesTest, ALineThatNeverRunsEmptyDoesNotHoldTheCaller) {
  line_.before_read = [this] { arrives("noise"); };
  EXPECT_EQ(messages_.write("POS?").error().code, ErrorCode::kProtocol);
  EXPECT_EQ(messages_.clear().error().code, ErrorCode::kProtocol);
}

TEST_F(LineMessagesTest, ALineThatIsGoneSaysSoInEveryCall) {
  line_.failure = Error{ErrorCode::kUnplugged, "gone"};
  EXPECT_EQ(messages_.write("POS?").error().code, ErrorCode::kUnplugged);
  EXPECT_EQ(messages_.read(1s).error().code, ErrorCode::kUnplugged);
  line_.failure.reset();
  line_.write_failure = Error{ErrorCode::kUnplugged, "gone"};
  EXPECT_EQ(messages_.clear().error().code, ErrorCode::kUnplugged);
}

}  // namespace
}  // namespace fogbench::drivers
