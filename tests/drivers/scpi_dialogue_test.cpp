#include "drivers/scpi_dialogue.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>

#include "tests/support/fake_transports.hpp"

namespace fogbench::drivers {
namespace {

class ScpiDialogueTest : public testing::Test {
 protected:
  ScpiDialogueTest() {
    device_.name = "test supply";
    device_.identity = "KEPCO,BOP";
    device_.initialise = {"FUNC:MODE CURR", "VOLT 30"};
    device_.set = "CURR {value}";
    far_.answers = {{"*IDN?", "KEPCO,BOP 36-6M,E12345,4.10"}, {"MEAS:CURR?", "-1.112E+00"}};
  }
  Result<ScpiDialogue> open() {
    return ScpiDialogue::open("coil", device_, std::make_unique<support::FakeMessages>(far_),
                              clock_);
  }
  ScpiDialogue opened() {
    auto dialogue = open();
    EXPECT_TRUE(dialogue) << dialogue.error().message;
    far_.sent.clear();
    return std::move(*dialogue);
  }

  config::ScpiDevice device_;
  support::FakeScpi far_;
  const Error timeout_{ErrorCode::kTimeout, "no answer in 1 s"};
  VirtualClock clock_;
};

TEST_F(ScpiDialogueTest, OpensByClearingIdentifyingForgettingOldErrorsAndInitialising) {
  far_.errors = {"-113,\"Undefined header\"", "-410,\"Query INTERRUPTED\""};
  const auto dialogue = open();
  ASSERT_TRUE(dialogue) << dialogue.error().message;
  EXPECT_EQ(dialogue->identity(), "KEPCO,BOP 36-6M,E12345,4.10");
  EXPECT_EQ(far_.clears, 1);
  EXPECT_EQ(far_.sent,
            (std::vector<std::string>{"*IDN?", "SYST:ERR?", "SYST:ERR?", "SYST:ERR?",
                                      "FUNC:MODE CURR", "SYST:ERR?", "VOLT 30", "SYST:ERR?"}));
}

TEST_F(ScpiDialogueTest, AnotherInstrumentIsADeviceError) {
  far_.answers["*IDN?"] = "ACME,Toaster\n\x01";
  const auto dialogue = open();
  ASSERT_FALSE(dialogue);
  EXPECT_EQ(dialogue.error().code, ErrorCode::kDevice);
  EXPECT_EQ(dialogue.error().message, "coil: says that it is ACME,Toaster??, expected KEPCO,BOP");
  EXPECT_EQ(far_.sent, std::vector<std::string>{"*IDN?"});
}

TEST_F(ScpiDialogueTest, NeverSendsASelfTest) {
  device_.initialise.push_back("*cls;*tst?");
  const auto dialogue = open();
  ASSERT_FALSE(dialogue);
  EXPECT_EQ(dialogue.error().code, ErrorCode::kBadInput);
  EXPECT_TRUE(far_.sent.empty());
}

TEST_F(ScpiDialogueTest, ACommandToABusyInstrumentIsSentAgainWithAPause) {
  device_.busy_errors = {-213, 721};
  ScpiDialogue dialogue = opened();
  int busy = 3;
  far_.obey = [&](const std::string&) {
    if (busy-- > 0) far_.errors = {"721,\"Busy storing\""};
  };
  const auto begun = clock_.now();
  EXPECT_TRUE(dialogue.set(1.5));
  EXPECT_EQ(std::count(far_.sent.begin(), far_.sent.end(), "CURR 1.500000"), 4);
  EXPECT_GE(clock_.now() - begun, std::chrono::milliseconds{300});

  busy = 1000;
  const Status given_up = dialogue.set(1.5);
  ASSERT_FALSE(given_up);
  EXPECT_EQ(given_up.error().code, ErrorCode::kBusy);
  EXPECT_EQ(given_up.error().message,
            "coil: CURR 1.500000 was refused: 721,\"Busy storing\", for 10.0 s");
}

TEST_F(ScpiDialogueTest, WhatElseIsTheMatterWithABusyInstrumentIsFinal) {
  device_.busy_errors = {721};
  ScpiDialogue dialogue = opened();
  far_.obey = [&](const std::string&) {
    far_.errors = {"721,\"Busy storing\"", "-222,\"Data out of range\""};
  };
  EXPECT_EQ(dialogue.set(99.5).error().code, ErrorCode::kDevice);
  EXPECT_EQ(std::count(far_.sent.begin(), far_.sent.end(), "CURR 99.500000"), 1);
}

TEST_F(ScpiDialogueTest, ACommandReportsEveryEntryOfTheErrorQueue) {
  ScpiDialogue dialogue = opened();
  far_.obey = [&](const std::string&) {
    far_.errors = {"-222,\"Data out of range\"", "-310,\"System error\""};
  };
  const Status status = dialogue.set(99.5);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kDevice);
  EXPECT_EQ(status.error().message,
            "coil: CURR 99.500000 was refused: -222,\"Data out of range\"; -310,\"System error\"");
  EXPECT_TRUE(far_.errors.empty());
  far_.obey = nullptr;
  EXPECT_TRUE(dialogue.set(1.0));
}

TEST_F(ScpiDialogueTest, AnErrorQueueThatDoesNotEndIsAProtocolError) {
  ScpiDialogue dialogue = opened();
  far_.errors.assign(200, "-350,\"Queue overflow\"");
  const Status status = dialogue.command("OUTP ON");
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kProtocol);
}

TEST_F(ScpiDialogueTest, AnErrorQueueThatAnswersNonsenseIsAProtocolError) {
  ScpiDialogue dialogue = opened();
  far_.errors = {"hello"};
  const Status status = dialogue.command("OUTP ON");
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kProtocol);
}

TEST_F(ScpiDialogueTest, ALateAnswerIsForgottenAndTheQuestionPutAgain) {
  ScpiDialogue dialogue = opened();
  far_.read_failures = {timeout_};
  const int clears = far_.clears;
  EXPECT_EQ(*dialogue.query_value("MEAS:CURR?"), -1.112);
  EXPECT_EQ(far_.clears, clears + 1);
  EXPECT_EQ(far_.sent, (std::vector<std::string>{"MEAS:CURR?", "SYST:ERR?", "MEAS:CURR?"}));
}

TEST_F(ScpiDialogueTest, AnAnswerToAnotherQuestionIsThrownAwayAndTheQuestionPutAgain) {
  ScpiDialogue dialogue = opened();
  far_.read_failures = {{ErrorCode::kProtocol, "the answer is to another request"}};
  EXPECT_EQ(*dialogue.query_value("MEAS:CURR?"), -1.112);
}

TEST_F(ScpiDialogueTest, WhatAFailedQuestionLeavesInTheErrorQueueIsNotBlamedOnTheNextCommand) {
  ScpiDialogue dialogue = opened();
  far_.read_failures = {timeout_};
  far_.errors = {"-200,\"Execution error\""};
  EXPECT_TRUE(dialogue.query_value("MEAS:CURR?"));
  const Status status = dialogue.command("OUTP ON");
  EXPECT_TRUE(status) << status.error().message;
}

TEST_F(ScpiDialogueTest, AQuestionThatFailsTwiceSaysWhatTheErrorQueueHadAboutIt) {
  ScpiDialogue dialogue = opened();
  far_.answers.erase("MEAS:CURR?");
  far_.errors = {"-200,\"Execution error\"", "-420,\"Query UNTERMINATED\""};
  EXPECT_EQ(dialogue.query_value("MEAS:CURR?").error().message,
            "coil: MEAS:CURR?: no answer (-200,\"Execution error\"; -420,\"Query "
            "UNTERMINATED\")");
  far_.answers["MEAS:CURR?"] = "0";
  EXPECT_TRUE(dialogue.query_value("MEAS:CURR?"));
  EXPECT_TRUE(dialogue.command("OUTP ON"));
}

TEST_F(ScpiDialogueTest, OneAnswerThatIsNoNumberIsForgiven) {
  ScpiDialogue dialogue = opened();
  far_.answers["MEAS:CURR?"] = "#@!";
  int asked = 0;
  far_.before_write = [&](const std::string& text) {
    if (text == "MEAS:CURR?" && ++asked == 2) far_.answers["MEAS:CURR?"] = "1.5";
  };
  EXPECT_EQ(*dialogue.query_value("MEAS:CURR?"), 1.5);
}

TEST_F(ScpiDialogueTest, TwoLostAnswersAreATimeout) {
  ScpiDialogue dialogue = opened();
  // To the question, to the look into the error queue, and both once more.
  far_.read_failures = {timeout_, timeout_, timeout_, timeout_};
  const auto value = dialogue.query_value("MEAS:CURR?");
  ASSERT_FALSE(value);
  EXPECT_EQ(value.error().code, ErrorCode::kTimeout);
  EXPECT_EQ(value.error().message, "coil: MEAS:CURR?: no answer in 1 s");
}

TEST_F(ScpiDialogueTest, ACommandIsSentOnceEvenWhenItsTransferFails) {
  ScpiDialogue dialogue = opened();
  far_.write_failures = {timeout_};
  const Status status = dialogue.command("OUTP ON");
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kTimeout);
  EXPECT_TRUE(far_.sent.empty());
}

/// A supply that obeys "CURR x" and answers "CURR?".
void obey_current(support::FakeScpi& far) {
  far.answers["CURR?"] = "0";
  far.obey = [&far](const std::string& text) { far.answers["CURR?"] = text.substr(5); };
}

TEST_F(ScpiDialogueTest, ASetThatWasLostIsSentAgainAfterAReadBack) {
  device_.set_query = "CURR?";
  ScpiDialogue dialogue = opened();
  obey_current(far_);
  far_.write_failures = {timeout_};
  const Status status = dialogue.set(1.0);
  ASSERT_TRUE(status) << status.error().message;
  EXPECT_EQ(far_.sent, (std::vector<std::string>{"CURR?", "CURR 1.000000", "SYST:ERR?"}));
}

TEST_F(ScpiDialogueTest, ASetThatWasExecutedUnheardIsNotSentAgain) {
  device_.set_query = "CURR?";
  ScpiDialogue dialogue = opened();
  obey_current(far_);
  // Neither time that the error queue is asked for.
  far_.read_failures = {timeout_, timeout_};
  const Status status = dialogue.set(1.0);
  ASSERT_TRUE(status) << status.error().message;
  EXPECT_EQ(far_.sent,
            (std::vector<std::string>{"CURR 1.000000", "SYST:ERR?", "SYST:ERR?", "CURR?"}));
}

TEST_F(ScpiDialogueTest, ASetThatWasRefusedIsNotSentAgain) {
  device_.set_query = "CURR?";
  ScpiDialogue dialogue = opened();
  far_.obey = [&](const std::string&) { far_.errors = {"-222,\"Data out of range\""}; };
  EXPECT_EQ(dialogue.set(1.0).error().code, ErrorCode::kDevice);
  EXPECT_EQ(far_.sent.front(), "CURR 1.000000");
  EXPECT_EQ(std::count(far_.sent.begin(), far_.sent.end(), "CURR 1.000000"), 1);
}

TEST_F(ScpiDialogueTest, AnUnpluggedInstrumentIsNotAskedAgain) {
  ScpiDialogue dialogue = opened();
  far_.read_failures = {{ErrorCode::kUnplugged, "unplugged"}};
  const auto value = dialogue.query("MEAS:CURR?");
  ASSERT_FALSE(value);
  EXPECT_EQ(value.error().code, ErrorCode::kUnplugged);
  EXPECT_EQ(far_.sent.size(), 1u);
}

TEST_F(ScpiDialogueTest, AnInstrumentThatWasUnpluggedIsIdentifiedAndInitialisedAgain) {
  const std::vector<std::string> begun{"*IDN?",     "SYST:ERR?", "FUNC:MODE CURR",
                                       "SYST:ERR?", "VOLT 30",   "SYST:ERR?"};
  const Error gone{ErrorCode::kUnplugged, "unplugged"};
  const std::pair<std::function<void(ScpiDialogue&)>, std::vector<std::string>> ways[] = {
      {[&](ScpiDialogue& d) {
         far_.read_failures = {gone};
         EXPECT_FALSE(d.query("MEAS:CURR?"));
       },
       {"MEAS:CURR?"}},
      {[&](ScpiDialogue& d) {
         far_.write_failures = {gone};
         EXPECT_FALSE(d.set(1.0));
       },
       {"CURR 0.000000", "SYST:ERR?"}}};
  for (const auto& [lose, then] : ways) {
    ScpiDialogue dialogue = opened();
    lose(dialogue);
    far_.sent.clear();
    far_.write_failures = {gone, gone};  // not back yet
    EXPECT_EQ(dialogue.query("MEAS:CURR?").error().code, ErrorCode::kUnplugged);
    EXPECT_EQ(dialogue.set(0.0).error().code, ErrorCode::kUnplugged);
    EXPECT_TRUE(far_.sent.empty());
    if (then.front() == "MEAS:CURR?") {
      EXPECT_TRUE(dialogue.query("MEAS:CURR?"));
    } else {
      EXPECT_TRUE(dialogue.set(0.0));
    }
    std::vector<std::string> expected = begun;
    expected.insert(expected.end(), then.begin(), then.end());
    EXPECT_EQ(far_.sent, expected);
    EXPECT_TRUE(dialogue.query("MEAS:CURR?"));
    EXPECT_EQ(far_.sent.size(), expected.size() + 1) << "once only";
  }
}

TEST_F(ScpiDialogueTest, AnotherInstrumentInItsPlaceIsNotCommanded) {
  ScpiDialogue dialogue = opened();
  far_.read_failures = {{ErrorCode::kUnplugged, "unplugged"}};
  EXPECT_FALSE(dialogue.query("MEAS:CURR?"));
  far_.answers["*IDN?"] = "ACME,Toaster";
  far_.sent.clear();
  for (int i = 0; i < 2; ++i) EXPECT_EQ(dialogue.set(1.0).error().code, ErrorCode::kDevice);
  EXPECT_FALSE(far_.was_sent("CURR 1.000000"));
}

TEST_F(ScpiDialogueTest, NumbersAreReadAsInstrumentsWriteThem) {
  ScpiDialogue dialogue = opened();
  const std::pair<const char*, double> good[] = {
      {"+1.5", 1.5}, {" -2.5E-03\r\n", -2.5e-3}, {"0", 0.0}, {".25", 0.25}};
  for (const auto& [text, value] : good) {
    far_.answers["MEAS:CURR?"] = text;
    EXPECT_EQ(*dialogue.query_value("MEAS:CURR?"), value) << text;
  }
  for (const char* text : {"", "A 1.5", "1.5 A", "nan", "inf", "9.91E37", "-9.9E37"}) {
    far_.answers["MEAS:CURR?"] = text;
    const auto value = dialogue.query_value("MEAS:CURR?");
    ASSERT_FALSE(value) << text;
    EXPECT_EQ(value.error().code, ErrorCode::kProtocol) << text;
  }
}

TEST_F(ScpiDialogueTest, ASetWithoutAPlaceForTheValueIsBadInput) {
  device_.set = "CURR";
  const auto dialogue = open();
  ASSERT_FALSE(dialogue);
  EXPECT_EQ(dialogue.error().code, ErrorCode::kBadInput);
}

}  // namespace
}  // namespace fogbench::drivers
