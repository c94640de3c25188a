#include "drivers/modbus_port.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <mutex>

#include "tests/support/modbus_server.hpp"
#include "tests/support/own_locks.hpp"
#include "tests/support/pty.hpp"

namespace fogbench::drivers {
namespace {

using support::Bytes;
using support::ModbusRequest;
using support::ModbusServer;
using testing::ElementsAre;
using testing::HasSubstr;
using namespace std::chrono_literals;

/// Register i holds 100 + i until it is written. The first answers may be late, missing or broken.
class Registers {
 public:
  ModbusServer::Answer answers() {
    return [this](const ModbusRequest& r) { return answer(r); };
  }
  std::uint16_t at(std::size_t i) {
    const std::lock_guard lock(mutex_);
    return words_[i];
  }
  std::atomic<int> late{0};    ///< so many answers come 200 ms too late
  std::atomic<int> silent{0};  ///< so many do not come, though the request is executed
  std::atomic<bool> slow{false};
  std::atomic<int> exception{0};  ///< what everything is answered with; 0: as it should be
  std::atomic<int> unit{-1};      ///< that was asked last

 private:
  std::optional<Bytes> answer(const ModbusRequest& r) {
    if (slow) std::this_thread::sleep_for(400ms);
    if (late > 0) {
      --late;
      std::this_thread::sleep_for(700ms);
    }
    unit = r.unit;
    if (exception != 0) {
      return support::exception_answer(r.function, static_cast<std::uint8_t>(exception.load()));
    }
    const std::lock_guard lock(mutex_);
    if (r.address + r.count > words_.size()) return support::exception_answer(r.function, 2);
    const auto first = words_.begin() + r.address;
    if (r.function == 16) std::copy(r.values.begin(), r.values.end(), first);
    if (silent > 0) {
      --silent;
      return std::nullopt;
    }
    return r.function == 16 ? support::written_answer(r)
                            : support::registers_answer({first, first + r.count});
  }
  std::mutex mutex_;
  std::vector<std::uint16_t> words_{100, 101, 102, 103, 104, 105, 106, 107};
};

/// The same must hold on both kinds of line.
class ModbusPort : public testing::TestWithParam<const char*> {
 protected:
  ModbusPort() { serve(); }
  bool is_tcp() const { return GetParam() == std::string("tcp"); }
  void serve() {
    server_.reset();
    const auto spoilt = [this](Bytes& frame) {
      if (const std::lock_guard lock(mutex_); spoil_) spoil_(frame);
    };
    server_ = is_tcp() ? ModbusServer::tcp(registers_.answers(), spoilt, port_)
                       : ModbusServer::rtu(registers_.answers(), spoilt, pty_.fd());
    port_ = server_->port();
  }
  void spoil(ModbusServer::Spoil spoil) {
    const std::lock_guard lock(mutex_);
    spoil_ = std::move(spoil);
  }
  void unplug() {
    server_.reset();
    if (!is_tcp()) pty_.unplug();
  }
  void plug_in() {
    if (!is_tcp()) pty_.plug_in();
    serve();
  }
  Result<std::unique_ptr<ModbusTransport>> try_open(std::uint8_t unit = 1) {
    return is_tcp() ? open_modbus(config::TcpConnection{"127.0.0.1", port_}, unit, clock_)
                    : open_modbus(config::RtuConnection{pty_.path(), 19200}, unit, clock_);
  }
  std::unique_ptr<ModbusTransport> open(std::uint8_t unit = 1) {
    auto opened = try_open(unit);
    EXPECT_TRUE(opened) << opened.error().message;
    return opened ? std::move(*opened) : nullptr;
  }
  static Result<std::uint16_t> read(ModbusTransport& port, std::uint16_t address) {
    std::uint16_t word = 0;
    if (const Status done = port.read_registers(address, {&word, 1}); !done) return done.error();
    return word;
  }

  support::OwnLocks locks_;
  support::Pty pty_;
  Registers registers_;
  std::mutex mutex_;
  ModbusServer::Spoil spoil_;
  std::uint16_t port_ = 0;
  std::unique_ptr<ModbusServer> server_;
  VirtualClock clock_;
};
INSTANTIATE_TEST_SUITE_P(, ModbusPort, testing::Values("tcp", "rtu"),
                         [](const auto& line) { return std::string(line.param); });

TEST_P(ModbusPort, ReadsAndWritesRegisters) {
  const auto port = open();
  std::uint16_t words[3] = {};
  ASSERT_TRUE(port->read_registers(2, words));
  EXPECT_THAT(words, ElementsAre(102, 103, 104));
  const std::uint16_t values[] = {7, 0xFFFF};
  ASSERT_TRUE(port->write_registers(4, values));
  EXPECT_EQ(registers_.at(4), 7);
  EXPECT_EQ(registers_.at(5), 0xFFFF);
  EXPECT_EQ(*read(*port, 5), 0xFFFF);
}

TEST_P(ModbusPort, ARefusalHasItsNumberAndEndsNothing) {
  const auto port = open();
  const auto refused = read(*port, 100);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kDevice);
  EXPECT_THAT(refused.error().message, HasSubstr("Modbus exception 2"));
  EXPECT_EQ(*read(*port, 1), 101);
}

TEST_P(ModbusPort, AnAnswerJustBeforeTheDeadlineIsTaken) {
  registers_.slow = true;
  EXPECT_EQ(*read(*open(), 3), 103);
}

TEST_P(ModbusPort, SilenceEndsInATimeOutWithinASecond) {
  const auto port = open();
  registers_.silent = 1;
  const auto begun = std::chrono::steady_clock::now();
  const auto none = read(*port, 1);
  const auto took = std::chrono::steady_clock::now() - begun;
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kTimeout);
  EXPECT_THAT(none.error().message, HasSubstr(is_tcp() ? "127.0.0.1:" : pty_.path()));
  EXPECT_GE(took, 450ms);
  EXPECT_EQ(*read(*port, 2), 102);
}

TEST_P(ModbusPort, ALateAnswerIsNeverTakenForTheNextOne) {
  const auto port = open();
  registers_.late = 1;
  EXPECT_EQ(read(*port, 1).error().code, ErrorCode::kTimeout);
  EXPECT_EQ(*read(*port, 5), 105);
  EXPECT_EQ(*read(*port, 6), 106);
}

TEST_P(ModbusPort, AWriteWithoutAnswerIsNotRepeated) {
  const auto port = open();
  registers_.silent = 1;
  const std::uint16_t value = 9;
  EXPECT_EQ(port->write_registers(0, {&value, 1}).error().code, ErrorCode::kTimeout);
  EXPECT_EQ(server_->requests(), 1);
  EXPECT_EQ(registers_.at(0), 9);
}

TEST_P(ModbusPort, AGarbledAnswerIsAnErrorAndTheNextIsRight) {
  const auto port = open();
  // On RTU the check value; on TCP the request's number.
  spoil([this](Bytes& frame) { (is_tcp() ? frame[1] : frame.back()) ^= 0x5A; });
  const auto garbled = read(*port, 1);
  ASSERT_FALSE(garbled);
  EXPECT_EQ(garbled.error().code, ErrorCode::kProtocol);
  spoil(nullptr);
  EXPECT_EQ(*read(*port, 2), 102);
}

TEST_P(ModbusPort, AnAnswerThatBreaksOffIsATimeOut) {
  const auto port = open();
  spoil([](Bytes& frame) { frame.pop_back(); });
  EXPECT_EQ(read(*port, 1).error().code, ErrorCode::kTimeout);
  spoil(nullptr);
  EXPECT_EQ(*read(*port, 2), 102);
}

TEST_P(ModbusPort, SaysAtOnceThatItIsGoneAndFindsItAgain) {
  const auto port = open();
  EXPECT_EQ(*read(*port, 1), 101);
  unplug();
  const auto begun = std::chrono::steady_clock::now();
  for (int i = 0; i < 3; ++i) {
    const auto gone = read(*port, 1);
    ASSERT_FALSE(gone);
    EXPECT_EQ(gone.error().code, ErrorCode::kUnplugged) << gone.error().message;
    clock_.sleep_for(1s);
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begun, 1s);
  plug_in();
  clock_.sleep_for(1s);
  EXPECT_EQ(*read(*port, 1), 101);
}

TEST_P(ModbusPort, WhereNobodyIsThereACallSaysSo) {
  unplug();
  const auto port = try_open();
  ASSERT_TRUE(port) << port.error().message;
  const auto answer = read(**port, 1);
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, ErrorCode::kUnplugged);
  EXPECT_THAT(answer.error().message, HasSubstr(is_tcp() ? "cannot connect to" : "cannot open"));
}

TEST_P(ModbusPort, AnAnswerOfAnotherUnitIsNotTaken) {
  const auto port = open();
  spoil([this](Bytes& frame) {
    const std::size_t unit = is_tcp() ? 6 : 0;
    frame[unit] = 9;
    if (is_tcp()) return;
    frame.resize(frame.size() - 2);
    const std::uint16_t crc = support::modbus_crc(frame);
    frame.push_back(static_cast<std::uint8_t>(crc));
    frame.push_back(static_cast<std::uint8_t>(crc >> 8));
  });
  const auto others = read(*port, 1);
  ASSERT_FALSE(others);
  EXPECT_EQ(others.error().code, ErrorCode::kProtocol);
  EXPECT_THAT(others.error().message, HasSubstr("an answer of unit 9 to a request to unit 1"));
  spoil(nullptr);
  EXPECT_EQ(*read(*port, 2), 102);
}

TEST_P(ModbusPort, OnlyWhatAsksForTimeIsBusy) {
  const auto port = open();
  for (const int code : {5, 6, 10, 11}) {
    registers_.exception = code;
    const auto busy = read(*port, 1);
    ASSERT_FALSE(busy);
    EXPECT_EQ(busy.error().code, ErrorCode::kBusy) << code;
    EXPECT_THAT(busy.error().message, HasSubstr("Modbus exception " + std::to_string(code)));
  }
  for (const int code : {1, 2, 3, 4, 7, 8, 99}) {
    registers_.exception = code;
    const auto refused = read(*port, 1);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kDevice) << code;
    EXPECT_THAT(refused.error().message, HasSubstr("Modbus exception " + std::to_string(code)));
  }
  registers_.exception = 0;
  EXPECT_EQ(*read(*port, 1), 101);
}

TEST_P(ModbusPort, BelongsToOneUntilItIsClosedPluggedInOrNot) {
  auto port = open();
  const int before = server_->requests();
  const auto second = try_open();
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::kHeld);
  EXPECT_THAT(second.error().message, HasSubstr("is held by this program already"));
  EXPECT_EQ(server_->requests(), before);
  unplug();
  EXPECT_EQ(try_open().error().code, ErrorCode::kHeld);
  plug_in();
  port.reset();
  EXPECT_EQ(*read(*open(), 1), 101);
}

TEST_P(ModbusPort, TheUnitsOfASerialLineAreNumberedAndOverTcpMayBeAnybody) {
  for (const std::uint8_t unit : {std::uint8_t{0}, std::uint8_t{255}}) {
    auto opened = try_open(unit);
    ASSERT_EQ(static_cast<bool>(opened), is_tcp());
    if (!is_tcp()) {
      EXPECT_EQ(opened.error().code, ErrorCode::kBadInput);
      EXPECT_THAT(opened.error().message, HasSubstr("expected 1 to 247"));
      continue;
    }
    EXPECT_EQ(*read(**opened, 1), 101);
    const std::uint16_t value = 9;
    EXPECT_TRUE((*opened)->write_registers(0, {&value, 1}));
    EXPECT_EQ(registers_.unit, unit);
  }
  EXPECT_EQ(*read(*open(247), 1), 101);
  EXPECT_EQ(registers_.unit, 247);
}

class ModbusGateway : public ModbusPort {};
INSTANTIATE_TEST_SUITE_P(, ModbusGateway, testing::Values("tcp"));

TEST_P(ModbusGateway, ThatClosesAfterEachAnswerIsReadAndWritten) {
  server_->closes_after_each = true;
  const auto port = open();
  // It closes while the next request is on its way, at most once: then it is known.
  EXPECT_EQ(*read(*port, 1), 101);
  (void)read(*port, 1);
  for (std::uint16_t value = 0; value < 50; ++value) {
    const Status written = port->write_registers(0, {&value, 1});
    ASSERT_TRUE(written) << value << ": " << written.error().message;
    ASSERT_EQ(*read(*port, 0), value);
  }
}

TEST_P(ModbusGateway, ThatHasClosedInTheMeantimeIsMetAnew) {
  const auto port = open();
  for (int i = 0; i < 3; ++i) EXPECT_EQ(*read(*port, 1), 101);
  serve();
  poll(nullptr, 0, 20);
  const std::uint16_t value = 7;
  EXPECT_TRUE(port->write_registers(0, {&value, 1}));
}

class ModbusEcho : public ModbusPort {};
INSTANTIATE_TEST_SUITE_P(, ModbusEcho, testing::Values("rtu"));

TEST_P(ModbusEcho, IsTakenOffWhereItIsDeclared) {
  server_->echoes = true;
  const auto port = open_modbus(
      config::RtuConnection{.tty = pty_.path(), .baud = 19200, .echoes = true}, 1, clock_);
  ASSERT_TRUE(port) << port.error().message;
  EXPECT_EQ(*read(**port, 1), 101);
  const std::uint16_t values[] = {7, 8};
  EXPECT_TRUE((*port)->write_registers(0, values));
  EXPECT_EQ(*read(**port, 1), 8);
  server_->echoes = false;
  const auto silent = read(**port, 1);
  ASSERT_FALSE(silent) << "an answer is no echo";
}

TEST_P(ModbusEcho, IsAskedAboutWhereItIsNotDeclared) {
  server_->echoes = true;
  const auto port = open();
  const auto echoed = read(*port, 1);
  ASSERT_FALSE(echoed);
  EXPECT_THAT(echoed.error().message, HasSubstr(":echo"));
}

}  // namespace
}  // namespace fogbench::drivers
