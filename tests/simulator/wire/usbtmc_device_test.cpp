#include "simulator/wire/usbtmc_device.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <string>

#include "simulator/far_ends.hpp"
#include "tests/simulator/test_bench.hpp"

namespace fogbench::simulator {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using State = UsbTransfer::State;

Bytes message(std::uint8_t tag, const std::string& text, bool end = true) {
  Bytes out{1, tag, static_cast<std::uint8_t>(~tag), 0};
  append_le32(out, static_cast<std::uint32_t>(text.size()));
  append_le32(out, end ? 1 : 0);
  out.insert(out.end(), text.begin(), text.end());
  out.resize((out.size() + 3) / 4 * 4);
  return out;
}

Bytes request(std::uint8_t tag, std::uint32_t size = 1024) {
  Bytes out{2, tag, static_cast<std::uint8_t>(~tag), 0};
  append_le32(out, size);
  append_le32(out, 0);
  return out;
}

class UsbtmcDeviceTest : public testing::Test {
 protected:
  explicit UsbtmcDeviceTest(const config::ScenarioConfig& scenario = {})
      : ends_(*make_far_ends(test_bench(), scenario, 1, clock_, 250ms)),
        supply_({.vendor_id = 0x1209, .product_id = 2, .serial = "S-1"}, *ends_.coil_horizontal,
                clock_) {}

  /// A transfer out, once the device has time for it.
  State out(const Bytes& bytes) {
    machine_.sleep_for(10ms);
    return supply_.out(1, bytes).state;
  }
  /// What comes in after 10 ms, text without the header.
  std::string in(std::size_t most = 1024) {
    machine_.sleep_for(10ms);
    const UsbTransfer transfer = supply_.in(2, most);
    if (transfer.state != State::kDone || transfer.data.size() < kUsbtmcHeaderBytes) return "none";
    EXPECT_EQ(transfer.data.size() % 4, 0U);
    last_header_.assign(transfer.data.begin(), transfer.data.begin() + 12);
    const auto text = transfer.data.begin() + 12;
    return {text, text + static_cast<std::ptrdiff_t>(le32_at(transfer.data, 4))};
  }
  std::string ask(const std::string& question) {
    EXPECT_EQ(out(message(1, question)), State::kDone);
    EXPECT_EQ(out(request(2)), State::kDone);
    return in();
  }
  Bytes control(UsbtmcRequest code, std::uint16_t value = 0) {
    return supply_
        .control({.request_type = 0xA1,
                  .request = static_cast<std::uint8_t>(code),
                  .value = value,
                  .index = 0,
                  .length = 64},
                 {})
        .data;
  }

  drivers::VirtualClock machine_;
  DeferringClock clock_{machine_};
  FarEnds ends_;
  UsbtmcDevice supply_;
  Bytes last_header_;
};

TEST_F(UsbtmcDeviceTest, AnswersAQueryUnderTheTagOfTheRequest) {
  EXPECT_EQ(out(message(1, "*IDN?\n")), State::kDone);
  EXPECT_EQ(out(request(9)), State::kDone);
  EXPECT_EQ(in(), "KEPCO,BOP 36-6\n");
  EXPECT_EQ(last_header_, (Bytes{2, 9, 0xF6, 0, 15, 0, 0, 0, 1, 0, 0, 0}));
}

TEST_F(UsbtmcDeviceTest, TakesItsTimeWithoutHoldingUpTheThread) {
  ASSERT_EQ(supply_.out(1, message(1, "*IDN?")).state, State::kDone);
  const UsbTransfer refused = supply_.out(1, request(2));
  EXPECT_EQ(refused.state, State::kBusy);
  EXPECT_EQ(refused.until - machine_.now(), 5ms);
  machine_.sleep_until(refused.until);
  ASSERT_EQ(supply_.out(1, request(2)).state, State::kDone);
  const UsbTransfer waiting = supply_.in(2, 64);
  EXPECT_EQ(waiting.state, State::kBusy);
  EXPECT_EQ(waiting.until - machine_.now(), 5ms);
  machine_.sleep_until(waiting.until);
  EXPECT_EQ(supply_.in(2, 64).state, State::kDone);
}

TEST_F(UsbtmcDeviceTest, ACommandReachesTheInstrument) {
  EXPECT_EQ(out(message(1, "OUTP ON")), State::kDone);
  EXPECT_EQ(out(message(2, "CURR 1.5")), State::kDone);
  EXPECT_EQ(ask("CURR?"), "1.500000E+00\n");
}

TEST_F(UsbtmcDeviceTest, AMessageMayComeInPieces) {
  const Bytes whole = message(1, "CURR 0.25;CURR?");
  EXPECT_EQ(out(Bytes(whole.begin(), whole.begin() + 14)), State::kDone);
  EXPECT_EQ(out(Bytes(whole.begin() + 14, whole.end())), State::kDone);
  EXPECT_EQ(out(request(2)), State::kDone);
  EXPECT_EQ(in(), "2.500000E-01\n");

  EXPECT_EQ(out(message(3, "CURR 0.5;", false)), State::kDone);
  EXPECT_EQ(out(message(4, "CURR?")), State::kDone);
  EXPECT_EQ(out(request(5)), State::kDone);
  EXPECT_EQ(in(), "5.000000E-01\n");
}

TEST_F(UsbtmcDeviceTest, AnAnswerIsGivenInThePiecesAskedFor) {
  EXPECT_EQ(out(message(1, "*IDN?")), State::kDone);
  EXPECT_EQ(out(request(2, 6)), State::kDone);
  EXPECT_EQ(in(), "KEPCO,");
  EXPECT_EQ(last_header_[8], 0) << "the message goes on";
  EXPECT_EQ(out(request(3, 100)), State::kDone);
  EXPECT_EQ(in(), "BOP 36-6\n");
  EXPECT_EQ(last_header_[8], 1);
}

TEST_F(UsbtmcDeviceTest, AHostMayFetchATransferBitByBit) {
  EXPECT_EQ(out(message(1, "CURR?")), State::kDone);
  EXPECT_EQ(out(request(2)), State::kDone);
  machine_.sleep_for(10ms);
  Bytes all;
  for (int i = 0; i < 7; ++i) append(all, supply_.in(2, 4).data);
  EXPECT_EQ(all, encode_usbtmc_answer(2, "0.000000E+00\n", true));
  EXPECT_EQ(supply_.in(2, 4).state, State::kBusy);
}

TEST_F(UsbtmcDeviceTest, WhatIsNoMessageHaltsTheEndpointUntilTheHostClearsIt) {
  const std::vector<Bytes> wrong = {
      {},
      {1, 1, 0xFE},
      Bytes(12),
      {1, 1, 0xFD, 0, 0, 0, 0, 0, 1, 0, 0, 0},              // tag and complement disagree
      {1, 0, 0xFF, 0, 0, 0, 0, 0, 1, 0, 0, 0},              // tag 0
      {128, 1, 0xFE, 0, 0, 0, 0, 0, 0, 0, 0, 0},            // a trigger
      {1, 1, 0xFE, 0, 0xFF, 0xFF, 0xFF, 0xFF, 1, 0, 0, 0},  // longer than any message
      request(1, 0),
  };
  for (const Bytes& bytes : wrong) {
    EXPECT_EQ(out(bytes), State::kStall) << testing::PrintToString(bytes);
    EXPECT_EQ(out(message(1, "*CLS")), State::kStall) << "halted";
    const UsbSetup clear_halt{.request_type = 0x02, .request = 1, .value = 0, .index = 1};
    EXPECT_EQ(supply_.control(clear_halt, {}).state, State::kDone);
    EXPECT_THAT(ask("*IDN?"), StartsWith("KEPCO"));
  }
}

TEST_F(UsbtmcDeviceTest, ARequestWithoutAnAnswerEndsWhenTheHostAbortsIt) {
  EXPECT_EQ(out(request(5)), State::kDone);
  machine_.sleep_for(10s);
  EXPECT_EQ(supply_.in(2, 64).state, State::kBusy);
  EXPECT_EQ(control(UsbtmcRequest::kInitiateAbortIn, 4), (Bytes{0x81, 5})) << "another tag";
  EXPECT_EQ(control(UsbtmcRequest::kInitiateAbortIn, 5), (Bytes{0x01, 5}));
  const UsbTransfer rest = supply_.in(2, 64);
  EXPECT_EQ(rest.state, State::kDone);
  EXPECT_TRUE(rest.data.empty());
  EXPECT_EQ(control(UsbtmcRequest::kCheckAbortIn), (Bytes{0x01, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(control(UsbtmcRequest::kInitiateAbortIn, 5), (Bytes{0x80, 5})) << "nothing under way";
  EXPECT_THAT(ask("SYST:ERR?"), StartsWith("-420"));
}

TEST_F(UsbtmcDeviceTest, AnAnswerNobodyFetchedComesBeforeTheNext) {
  EXPECT_EQ(out(message(1, "*IDN?")), State::kDone);
  EXPECT_EQ(out(request(2)), State::kDone);
  EXPECT_EQ(ask("CURR?"), "KEPCO,BOP 36-6\n");
  EXPECT_EQ(in(), "0.000000E+00\n");
}

TEST_F(UsbtmcDeviceTest, ClearForgetsWhatIsUnderWay) {
  EXPECT_EQ(out(message(1, "*IDN?")), State::kDone);
  EXPECT_EQ(out(request(2)), State::kDone);
  machine_.sleep_for(10ms);
  EXPECT_EQ(control(UsbtmcRequest::kInitiateClear), (Bytes{0x01}));
  EXPECT_EQ(control(UsbtmcRequest::kCheckClear), (Bytes{0x02, 0})) << "takes 5 ms";
  machine_.sleep_for(10ms);
  EXPECT_EQ(control(UsbtmcRequest::kCheckClear), (Bytes{0x01, 0}));
  EXPECT_EQ(in(), "none");
  EXPECT_EQ(ask("CURR?"), "0.000000E+00\n");
}

TEST_F(UsbtmcDeviceTest, AnAbortedMessageIsNotExecuted) {
  const Bytes whole = message(3, "CURR 1");
  EXPECT_EQ(control(UsbtmcRequest::kInitiateAbortOut, 3), (Bytes{0x80, 3})) << "nothing under way";
  EXPECT_EQ(out(Bytes(whole.begin(), whole.begin() + 14)), State::kDone);
  EXPECT_EQ(control(UsbtmcRequest::kInitiateAbortOut, 2), (Bytes{0x81, 3})) << "another tag";
  EXPECT_EQ(control(UsbtmcRequest::kInitiateAbortOut, 3), (Bytes{0x01, 3}));
  EXPECT_EQ(control(UsbtmcRequest::kCheckAbortOut), (Bytes{0x01, 0, 0, 0, 14, 0, 0, 0}));
  EXPECT_EQ(ask("CURR?"), "0.000000E+00\n");
}

TEST_F(UsbtmcDeviceTest, TheStatusByteTellsOfAnswersAndErrors) {
  EXPECT_EQ(control(UsbtmcRequest::kReadStatusByte, 2), (Bytes{0x01, 2, 0x00}));
  EXPECT_EQ(out(message(1, "NONSENSE")), State::kDone);
  EXPECT_EQ(control(UsbtmcRequest::kReadStatusByte, 3), (Bytes{0x01, 3, 0x04}));
  EXPECT_EQ(out(message(1, "CURR?")), State::kDone);
  EXPECT_EQ(control(UsbtmcRequest::kReadStatusByte, 4), (Bytes{0x01, 4, 0x14}));
}

TEST_F(UsbtmcDeviceTest, SaysWhatItCanDo) {
  const Bytes capabilities = control(UsbtmcRequest::kGetCapabilities);
  ASSERT_EQ(capabilities.size(), 24U);
  EXPECT_EQ(capabilities[0], 0x01);
  EXPECT_EQ(le16_at(capabilities, 2), 0x0100);
  EXPECT_EQ(le16_at(capabilities, 12), 0x0100);
  EXPECT_EQ(capabilities[14], 0x04) << "USB488";
  EXPECT_EQ(capabilities[15], 0x08) << "SCPI";
}

config::ScenarioConfig with(config::FaultKind kind) {
  config::ScenarioConfig scenario;
  scenario.faults = {fault("coil_horizontal", kind, 5.0, 5.0)};
  return scenario;
}

class SilentSupplyTest : public UsbtmcDeviceTest {
 protected:
  SilentSupplyTest() : UsbtmcDeviceTest(with(config::FaultKind::kTimeout)) {}
};

TEST_F(SilentSupplyTest, HearsNothingAndSaysNothing) {
  machine_.sleep_for(6s);
  EXPECT_EQ(out(message(1, "CURR 1")), State::kSilent);
  EXPECT_EQ(supply_.control({.request_type = 0xA1, .request = 5, .length = 1}, {}).state,
            State::kSilent);
  machine_.sleep_for(6s);
  EXPECT_EQ(ask("CURR?"), "0.000000E+00\n");
}

class LateSupplyTest : public UsbtmcDeviceTest {
 protected:
  LateSupplyTest() : UsbtmcDeviceTest(with(config::FaultKind::kLateAnswer)) {}
};

TEST_F(LateSupplyTest, AnswersWhenNobodyWaitsAnyMore) {
  machine_.sleep_for(6s);
  EXPECT_EQ(out(message(1, "*IDN?")), State::kDone);
  EXPECT_EQ(out(request(2)), State::kDone);
  machine_.sleep_for(1s);
  const UsbTransfer waiting = supply_.in(2, 64);
  EXPECT_EQ(waiting.state, State::kBusy);
  EXPECT_EQ(waiting.until - machine_.now(), 250ms);
  machine_.sleep_for(250ms);
  EXPECT_EQ(in(), "KEPCO,BOP 36-6\n");
}

TEST_F(LateSupplyTest, AnAbortedAnswerDoesNotComeLate) {
  machine_.sleep_for(6s);
  EXPECT_EQ(out(message(1, "*IDN?")), State::kDone);
  EXPECT_EQ(out(request(2)), State::kDone);
  machine_.sleep_for(1s);
  EXPECT_EQ(control(UsbtmcRequest::kInitiateAbortIn, 2), (Bytes{0x01, 2}));
  EXPECT_TRUE(supply_.in(2, 64).data.empty());
  machine_.sleep_for(5s);
  EXPECT_EQ(ask("CURR?"), "0.000000E+00\n");
}

class UnpluggedSupplyTest : public UsbtmcDeviceTest {
 protected:
  UnpluggedSupplyTest() : UsbtmcDeviceTest(with(config::FaultKind::kUnplug)) {}
};

TEST_F(UnpluggedSupplyTest, IsGone) {
  EXPECT_TRUE(supply_.plugged());
  machine_.sleep_for(6s);
  EXPECT_FALSE(supply_.plugged());
  EXPECT_EQ(out(message(1, "CURR 1")), State::kGone);
  machine_.sleep_for(6s);
  EXPECT_TRUE(supply_.plugged());
}

config::ScenarioConfig unplugged_by_the_first_set() {
  config::ScenarioConfig scenario;
  config::FaultSpec pulled;
  pulled.device = "coil_horizontal";
  pulled.kind = config::FaultKind::kUnplug;
  pulled.operation = "set";
  pulled.at_operation = 1;
  scenario.faults = {pulled};
  return scenario;
}

class PulledSupplyTest : public UsbtmcDeviceTest {
 protected:
  PulledSupplyTest() : UsbtmcDeviceTest(unplugged_by_the_first_set()) {}
};

TEST_F(PulledSupplyTest, TheOperationThatPullsThePlugIsNotExecutedAndThePlugIsBack) {
  EXPECT_EQ(ask("CURR?"), "0.000000E+00\n");
  EXPECT_EQ(out(message(1, "CURR 1")), State::kGone);
  EXPECT_TRUE(supply_.plugged());
  EXPECT_EQ(ask("CURR?"), "0.000000E+00\n");
  EXPECT_EQ(out(message(1, "CURR 1")), State::kDone);
  EXPECT_EQ(ask("CURR?"), "1.000000E+00\n");
}

}  // namespace
}  // namespace fogbench::simulator
