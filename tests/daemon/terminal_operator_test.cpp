#include "daemon/terminal_operator.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>

namespace fogbench::daemon {
namespace {

using testing::HasSubstr;

class TerminalOperatorTest : public testing::Test {
 protected:
  TerminalOperatorTest() {
    if (pipe(ends_) != 0) std::abort();
    shown_ = open_memstream(&text_, &size_);
  }
  ~TerminalOperatorTest() override {
    close(ends_[0]);
    hang_up();
    std::fclose(shown_);
    std::free(text_);
  }
  void types(const std::string& text) const {
    ASSERT_EQ(write(ends_[1], text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  void hang_up() {
    if (ends_[1] >= 0) close(ends_[1]);
    ends_[1] = -1;
  }
  std::string shown() {
    std::fflush(shown_);
    return {text_, size_};
  }

  int ends_[2] = {-1, -1};
  char* text_ = nullptr;
  std::size_t size_ = 0;
  std::FILE* shown_ = nullptr;
  bool aborted_ = false;
  TerminalOperator asked() {
    return {ends_[0], shown_, [this] { return aborted_; }};
  }
};

TEST_F(TerminalOperatorTest, AsksAndTakesYesForYesAndNoForNo) {
  auto person = asked();
  types("yes\nno\ny\r\nn\n");
  EXPECT_TRUE(*person.confirm("Turn the gyro."));
  EXPECT_FALSE(*person.confirm("Turn it back."));
  EXPECT_TRUE(*person.confirm("a"));
  EXPECT_FALSE(*person.confirm("b"));
  EXPECT_THAT(shown(), HasSubstr("Turn the gyro. [yes/no] Turn it back. [yes/no] "));
}

TEST_F(TerminalOperatorTest, AsksAgainWhenTheAnswerIsNeither) {
  auto person = asked();
  types("\nwhat?\nyes\n");
  EXPECT_TRUE(*person.confirm("Ready?"));
  EXPECT_EQ(shown(), "Ready? [yes/no] Ready? [yes/no] Ready? [yes/no] ");
}

TEST_F(TerminalOperatorTest, WhereNobodyCanAnswerItSaysSo) {
  auto person = asked();
  hang_up();
  const auto answer = person.confirm("Ready?");
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, ErrorCode::kDevice);
  EXPECT_THAT(answer.error().message, HasSubstr("nobody answers \"Ready?\""));
}

TEST_F(TerminalOperatorTest, AnAbortEndsTheWaiting) {
  auto person = asked();
  aborted_ = true;
  EXPECT_FALSE(*person.confirm("Ready?"));
}

}  // namespace
}  // namespace fogbench::daemon
