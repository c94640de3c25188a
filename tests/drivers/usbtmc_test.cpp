#include "drivers/usbtmc.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/support/fake_usb.hpp"

namespace fogbench::drivers {
namespace {

using support::FakeUsb;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using namespace std::chrono_literals;
using namespace usbtmc;  // NOLINT(google-build-using-namespace)

constexpr Clock::Duration kShort = 20ms;

TEST(UsbtmcMessages, AMessageIsHeadedMarkedAndPadded) {
  EXPECT_THAT(encode_message(7, "*IDN?\n"), ElementsAre(1, 7, 0xF8, 0, 6, 0, 0, 0, 1, 0, 0, 0, '*',
                                                        'I', 'D', 'N', '?', '\n', 0, 0));
  EXPECT_THAT(encode_request(255, 0x1234), ElementsAre(2, 255, 0, 0, 0x34, 0x12, 0, 0, 0, 0, 0, 0));
}

TEST(UsbtmcMessages, TagsGoRoundWithoutZero) {
  EXPECT_EQ(next_tag(0), 1);
  EXPECT_EQ(next_tag(254), 255);
  EXPECT_EQ(next_tag(255), 1);
  EXPECT_EQ(next_status_tag(0), 2);
  EXPECT_EQ(next_status_tag(126), 127);
  EXPECT_EQ(next_status_tag(127), 2);
}

TEST(UsbtmcMessages, AnAnswersHeaderIsReadOrRefused) {
  const auto bytes = FakeUsb::answer(9, "1.5\n");
  const auto header = decode_answer_header(bytes, 100);
  ASSERT_TRUE(header) << header.error().message;
  EXPECT_EQ(header->tag, 9);
  EXPECT_EQ(header->size, 4U);
  EXPECT_TRUE(header->is_last);
  EXPECT_FALSE(decode_answer_header(FakeUsb::answer(9, "1.5", false), 100)->is_last);

  const auto refused = [](std::vector<std::uint8_t> answer, std::uint32_t most,
                          const char* because) {
    const auto result = decode_answer_header(answer, most);
    ASSERT_FALSE(result) << because;
    EXPECT_EQ(result.error().code, ErrorCode::kProtocol);
    EXPECT_THAT(result.error().message, HasSubstr(because));
  };
  refused({}, 100, "of 0 bytes");
  refused(std::vector<std::uint8_t>(bytes.begin(), bytes.begin() + 11), 100, "of 11 bytes");
  refused(bytes, 3, "an answer of 4 bytes, asked for at most 3");
  auto other = bytes;
  other[0] = 126;
  refused(other, 100, "of kind 126");
  other = bytes;
  other[2] ^= 1;
  refused(other, 100, "tag 9 and its complement");
  other = bytes;
  other[1] = 0;
  other[2] = 0xFF;
  refused(other, 100, "tag 0");
}

TEST(UsbtmcMessages, NoBytesAreReadPast) {
  std::mt19937 random(1);
  for (int i = 0; i < 20000; ++i) {
    std::vector<std::uint8_t> bytes(random() % 20);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
    if (!bytes.empty() && i % 2 == 0) bytes[0] = kDevDepMsgIn;
    std::ignore = decode_answer_header(bytes, 4096);
  }
}

class UsbtmcTest : public testing::Test {
 protected:
  Result<std::string> ask(const std::string& question) {
    const Status sent = talk_.write(question, 1s);
    if (!sent) return sent.error();
    return talk_.read(kShort);
  }
  FakeUsb usb_;
  Usbtmc talk_{usb_};
};

TEST_F(UsbtmcTest, AsksAndIsAnswered) {
  usb_.answers["MEAS:CURR?\n"] = "1.112\r\n";
  for (int i = 0; i < 600; ++i) {  // more than twice round the tags
    const auto answer = ask("MEAS:CURR?");
    ASSERT_TRUE(answer) << answer.error().message;
    EXPECT_EQ(*answer, "1.112");
  }
}

TEST_F(UsbtmcTest, PutsAnAnswerTogetherFromItsTransfers) {
  usb_.most_per_answer = 7;
  usb_.answers["*IDN?\n"] = "KEPCO,BOP 36-6M,E1234,2.31\n";
  EXPECT_EQ(*ask("*IDN?"), "KEPCO,BOP 36-6M,E1234,2.31");
}

TEST_F(UsbtmcTest, ReadsAnAnswerWhoseTransferComesInPieces) {
  const std::string text(200, 'x');
  ASSERT_TRUE(talk_.write("*IDN?", 1s));
  const auto whole = FakeUsb::answer(2, text);
  usb_.transfers.push_back({whole.begin(), whole.begin() + 100});
  usb_.transfers.push_back({whole.begin() + 100, whole.end()});
  EXPECT_EQ(*talk_.read(kShort), text);
}

TEST_F(UsbtmcTest, ATimeOutIsAbortedDrainedAndTellsTheStatusByte) {
  usb_.silent = true;
  usb_.pending = 2;
  usb_.answers["MEAS:CURR?\n"] = "1.0\n";
  const auto answer = ask("MEAS:CURR?");
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, ErrorCode::kTimeout);
  EXPECT_EQ(answer.error().message, "no answer; its status byte is 0x10");
  EXPECT_THAT(usb_.requests,
              ElementsAre(kInitiateAbortBulkIn, kCheckAbortBulkInStatus, kCheckAbortBulkInStatus,
                          kCheckAbortBulkInStatus, kReadStatusByte));
}

TEST_F(UsbtmcTest, ALateAnswerIsNeverTakenForTheNextOne) {
  usb_.answers["MEAS:CURR?\n"] = "1.0\n";
  usb_.answers["CURR?\n"] = "2.0\n";
  // Late while the abort drains, and late after it: its tag tells.
  usb_.silent = true;
  ASSERT_FALSE(ask("MEAS:CURR?"));
  const std::uint8_t old_tag = usb_.last_tag();
  usb_.silent = false;
  usb_.pending_answer.clear();
  usb_.transfers.push_back(FakeUsb::answer(old_tag, "1.0\n"));
  const auto answer = ask("CURR?");
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_EQ(*answer, "2.0");
}

TEST_F(UsbtmcTest, DrainsWhatTheInstrumentStillHolds) {
  usb_.silent = true;
  usb_.pending = 1;
  usb_.held = FakeUsb::answer(99, std::string(180, 'z'));  // three packets
  EXPECT_EQ(ask("Q?").error().code, ErrorCode::kTimeout);
  EXPECT_TRUE(usb_.transfers.empty());
}

TEST_F(UsbtmcTest, AnAbortThatFindsNothingUnderWayIsDone) {
  usb_.silent = true;
  usb_.abort_status = kFailed;
  EXPECT_EQ(ask("Q?").error().code, ErrorCode::kTimeout);
  EXPECT_THAT(usb_.requests, Not(Contains(+kInitiateClear)));
}

TEST_F(UsbtmcTest, WhereAbortingFailsTheInterfaceIsCleared) {
  usb_.silent = true;
  usb_.abort_status = kTransferNotInProgress;
  EXPECT_EQ(ask("Q?").error().code, ErrorCode::kTimeout);
  EXPECT_THAT(usb_.requests, Contains(+kInitiateClear));
  EXPECT_EQ(usb_.halts_cleared, 1);
}

TEST_F(UsbtmcTest, GarbageIsAnErrorAndTheNextAnswerIsRight) {
  usb_.answers["Q?\n"] = "1\n";
  usb_.spoil = [](FakeUsb::Bytes& bytes) { bytes[0] = 77; };
  EXPECT_EQ(ask("Q?").error().code, ErrorCode::kProtocol);
  usb_.spoil = nullptr;
  EXPECT_EQ(*ask("Q?"), "1");
}

TEST_F(UsbtmcTest, AnAnswerThatAnnouncesMoreThanItSendsIsATimeOut) {
  usb_.answers["Q?\n"] = "123\n";
  usb_.spoil = [](FakeUsb::Bytes& bytes) { bytes[4] = 100; };
  EXPECT_EQ(ask("Q?").error().code, ErrorCode::kTimeout);
}

TEST_F(UsbtmcTest, AnAnswerWithoutEndIsAnError) {
  usb_.answers["Q?\n"] = std::string(2 << 20, 'x');
  ASSERT_TRUE(talk_.write("Q?", 1s));
  const auto answer = talk_.read(10s);
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, ErrorCode::kProtocol);
  EXPECT_THAT(usb_.requests, ElementsAre(kInitiateClear, kCheckClearStatus));
}

TEST_F(UsbtmcTest, AMessageThatIsNotTakenIsAborted) {
  usb_.out_failure = Error{ErrorCode::kTimeout, "sending"};
  EXPECT_EQ(talk_.write("CURR 1", 1s).error().code, ErrorCode::kTimeout);
  EXPECT_THAT(usb_.requests, ElementsAre(kInitiateAbortBulkOut, kCheckAbortBulkOutStatus));
  EXPECT_EQ(usb_.halts_cleared, 1);
  EXPECT_TRUE(talk_.write("CURR 1", 1s));
  EXPECT_THAT(usb_.messages, ElementsAre("CURR 1\n"));
}

TEST_F(UsbtmcTest, ARequestThatIsNotTakenIsCleared) {
  usb_.out_failure = Error{ErrorCode::kTimeout, "sending"};
  EXPECT_EQ(talk_.read(kShort).error().code, ErrorCode::kTimeout);
  EXPECT_THAT(usb_.requests, Contains(+kInitiateClear));
}

TEST_F(UsbtmcTest, ClearingWaitsUntilTheInstrumentIsDone) {
  usb_.pending = 3;
  usb_.transfers.push_back(FakeUsb::Bytes(64 * 3));
  EXPECT_TRUE(talk_.clear());
  EXPECT_TRUE(usb_.transfers.empty());
  EXPECT_EQ(usb_.halts_cleared, 1);
}

TEST_F(UsbtmcTest, AClearThatIsRefusedOrNeverEndsIsAnError) {
  usb_.clear_status = kFailed;
  EXPECT_EQ(talk_.clear().error().code, ErrorCode::kProtocol);
  usb_.clear_status = kSuccess;
  usb_.pending = 1'000'000;
  EXPECT_EQ(talk_.clear().error().code, ErrorCode::kTimeout);
  usb_.stalls_controls = true;
  EXPECT_EQ(talk_.clear().error().code, ErrorCode::kProtocol);
}

TEST_F(UsbtmcTest, TheStatusByteComesInTheAnswerOrOnTheInterruptEndpoint) {
  usb_.status = 0x44;
  EXPECT_EQ(*talk_.status_byte(), 0x44);
  usb_.interrupt_endpoint = true;
  usb_.interrupts.push_back({0x81, 0x40});  // a service request comes first
  EXPECT_EQ(*talk_.status_byte(), 0x44);
}

TEST_F(UsbtmcTest, WhenItIsGoneEveryCallSaysSoWithoutRecovery) {
  usb_.gone = Error{ErrorCode::kUnplugged, "gone"};
  EXPECT_EQ(talk_.write("Q?", 1s).error().code, ErrorCode::kUnplugged);
  EXPECT_EQ(talk_.read(kShort).error().code, ErrorCode::kUnplugged);
  EXPECT_EQ(talk_.clear().error().code, ErrorCode::kUnplugged);
  EXPECT_EQ(talk_.status_byte().error().code, ErrorCode::kUnplugged);
  EXPECT_TRUE(usb_.requests.empty());
}

}  // namespace
}  // namespace fogbench::drivers
