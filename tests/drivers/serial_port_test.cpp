#include "drivers/serial_port.hpp"

#include <asm/termbits.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/ioctl.h>

#include <atomic>
#include <thread>

#include "tests/support/own_locks.hpp"
#include "tests/support/pty.hpp"

namespace fogbench::drivers {
namespace {

using support::Pty;
using testing::HasSubstr;
using namespace std::chrono_literals;

class SerialPortTest : public testing::Test {
 protected:
  std::unique_ptr<SerialTransport> open(std::uint32_t baud = 921600) {
    auto port = open_serial(pty_.path(), baud, clock_);
    EXPECT_TRUE(port) << port.error().message;
    EXPECT_TRUE((*port)->write({}));  // which opens the line
    return std::move(*port);
  }
  /// What comes within a second.
  static std::string read(SerialTransport& port, std::size_t count) {
    std::string text;
    for (int i = 0; i < 1000 && text.size() < count; ++i) {
      std::byte bytes[4096];
      const auto got =
          port.read_some(std::span(bytes).first(std::min(sizeof bytes, count - text.size())));
      EXPECT_TRUE(got) << got.error().message;
      if (!got) break;
      text.append(reinterpret_cast<const char*>(bytes), *got);
      if (*got == 0) poll(nullptr, 0, 1);
    }
    return text;
  }

  static std::optional<ErrorCode> failure_within_a_second(SerialTransport& port) {
    for (int i = 0; i < 1000; ++i) {
      std::byte bytes[8];
      if (const auto got = port.read_some(bytes); !got) return got.error().code;
      poll(nullptr, 0, 1);
    }
    return std::nullopt;
  }

  support::OwnLocks locks_;
  Pty pty_;
  support::TemporaryFolder folder_;
  VirtualClock clock_;
};

TEST_F(SerialPortTest, CarriesEveryByteBothWaysUnchanged) {
  const auto port = open();
  std::string all;
  for (int i = 0; i < 256; ++i) all += static_cast<char>(i);
  pty_.send(all);
  EXPECT_EQ(read(*port, 256), all);
  ASSERT_TRUE(port->write(std::as_bytes(std::span(all))));
  EXPECT_EQ(pty_.receive(256), all);
}

TEST_F(SerialPortTest, AnEmptyLineIsNothingAndNoError) {
  const auto port = open();
  std::byte bytes[8];
  const auto count = port->read_some(bytes);
  ASSERT_TRUE(count) << count.error().message;
  EXPECT_EQ(*count, 0U);
}

TEST_F(SerialPortTest, RunsAtRatesThatHaveNoConstant) {
  for (const std::uint32_t baud : {9600U, 921600U, 1'843'200U, 123'456U}) {
    const auto port = open(baud);
    struct termios2 line {};
    ASSERT_EQ(ioctl(pty_.fd(), TCGETS2, &line), 0);
    EXPECT_EQ(line.c_ospeed, baud);
    EXPECT_EQ(line.c_ispeed, baud);
  }
}

TEST_F(SerialPortTest, WhatAnotherHasIsLeftAsItIs) {
  const auto first = open(9600);
  pty_.send("first's");
  const auto second = open_serial(pty_.path(), 115200, clock_);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::kHeld);
  struct termios2 line {};
  ASSERT_EQ(ioctl(pty_.fd(), TCGETS2, &line), 0);
  EXPECT_EQ(line.c_ospeed, 9600U);
  EXPECT_EQ(read(*first, 7), "first's");
}

TEST_F(SerialPortTest, OneThatAnotherProgramHasLockedIsNotTaken) {
  const int other = ::open(pty_.path().c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  ASSERT_EQ(flock(other, LOCK_EX), 0);
  const auto port = open_serial(pty_.path(), 9600, clock_);
  ASSERT_TRUE(port) << port.error().message;
  const Status taken = (*port)->write({});
  ASSERT_FALSE(taken);
  EXPECT_EQ(taken.error().code, ErrorCode::kHeld);
  EXPECT_EQ(taken.error().message, "serial line " + pty_.path() + " is held by another process");
  close(other);
  clock_.sleep_for(1s);
  EXPECT_TRUE((*port)->write({}));
}

TEST_F(SerialPortTest, IsHeldWhileItIsUnpluggedAndUnderEveryName) {
  auto first = open();
  const auto link = folder_ / "by-id";
  std::filesystem::create_symlink(pty_.path(), link);
  EXPECT_EQ(open_serial(link.string(), 9600, clock_).error().code, ErrorCode::kHeld);
  pty_.unplug();
  EXPECT_EQ(failure_within_a_second(*first), ErrorCode::kUnplugged);
  EXPECT_EQ(open_serial(pty_.path(), 9600, clock_).error().code, ErrorCode::kHeld);
  first.reset();
  pty_.plug_in();
  EXPECT_TRUE(open());
}

TEST_F(SerialPortTest, ThrowsAwayWhatTheLineHadKept) {
  { const auto before = open(); }
  pty_.send("old");
  const auto port = open();
  pty_.send("new");
  EXPECT_EQ(read(*port, 3), "new");
}

TEST_F(SerialPortTest, AMissingLineIsNamed) {
  const auto port = open_serial("/dev/no-such-line", 9600, clock_);
  ASSERT_TRUE(port);
  std::byte byte{};
  const auto count = (*port)->read_some({&byte, 1});
  ASSERT_FALSE(count);
  EXPECT_EQ(count.error().code, ErrorCode::kUnplugged);
  EXPECT_EQ(count.error().message, "cannot open /dev/no-such-line: No such file or directory");
}

TEST_F(SerialPortTest, WhatIsNoSerialLineIsRefused) {
  const auto port = open_serial("/dev/null", 9600, clock_);
  ASSERT_TRUE(port);
  const Status written = (*port)->write({});
  ASSERT_FALSE(written);
  EXPECT_THAT(written.error().message, HasSubstr("/dev/null is not a serial line"));
}

TEST_F(SerialPortTest, SaysWithinASecondThatTheLineIsGoneAndFindsItAgain) {
  const auto port = open();
  std::byte bytes[8];
  pty_.unplug();
  EXPECT_EQ(failure_within_a_second(*port), ErrorCode::kUnplugged);
  for (int i = 0; i < 3; ++i) {
    const auto gone = port->read_some(bytes);
    ASSERT_FALSE(gone);
    EXPECT_EQ(gone.error().code, ErrorCode::kUnplugged);
    EXPECT_THAT(gone.error().message, HasSubstr(pty_.path()));
  }
  EXPECT_EQ(port->write(bytes).error().code, ErrorCode::kUnplugged);
  pty_.plug_in();
  clock_.sleep_for(1s);
  std::ignore = port->read_some(bytes);  // opens it, which empties it
  pty_.send("back");
  EXPECT_EQ(read(*port, 4), "back");
}

TEST_F(SerialPortTest, WhatCameBeforeTheLineWentIsStillRead) {
  const auto port = open();
  pty_.send("last words");
  std::byte bytes[64];
  for (int i = 0; i < 1000 && *port->read_some({bytes, 1}) == 0; ++i) poll(nullptr, 0, 1);
  pty_.unplug();
  EXPECT_EQ(read(*port, 9), "ast words");
  EXPECT_EQ(failure_within_a_second(*port), ErrorCode::kUnplugged);
}

TEST_F(SerialPortTest, KeepsMoreThanTheKernelDoesForACallerWhoIsBusy) {
  const auto port = open();
  // A second of a gyro ten times, while nobody asks.
  std::string sent(36000, '\0');
  for (std::size_t i = 0; i < sent.size(); ++i) sent[i] = static_cast<char>(i * 31 >> 3);
  for (int second = 0; second < 10; ++second) {
    for (std::size_t at = 0; at < sent.size(); at += 1000) {
      pollfd room{pty_.fd(), POLLOUT, 0};
      ASSERT_EQ(poll(&room, 1, 2000), 1);
      pty_.send(sent.substr(at, 1000));
    }
  }
  for (int second = 0; second < 10; ++second) ASSERT_EQ(read(*port, sent.size()), sent) << second;
}

TEST_F(SerialPortTest, AWriteThatTheLineDoesNotTakeEndsInATimeOut) {
  const auto port = open();
  const std::vector<std::byte> much(1 << 20);
  const Status written = port->write(much);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::kTimeout);
}

TEST_F(SerialPortTest, TheLastWordsPassWhatIsUnderWayInAnotherThread) {
  const auto port = open();
  std::atomic<bool> done{false};
  std::thread reader([&] {
    std::byte bytes[8];
    while (!done) (void)port->read_some(bytes);
  });
  const std::string last = "\nCURR 0\n";
  port->write_last(std::as_bytes(std::span(last)));
  EXPECT_EQ(pty_.receive(last.size()), last);
  done = true;
  reader.join();
}

TEST_F(SerialPortTest, TheLastWordsOpenNothing) {
  const auto port = open_serial("/dev/no-such-line", 9600, clock_);
  ASSERT_TRUE(port);
  const std::string last = "CURR 0\n";
  (*port)->write_last(std::as_bytes(std::span(last)));
}

}  // namespace
}  // namespace fogbench::drivers
