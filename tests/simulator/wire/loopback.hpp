#pragma once
// A bench served on this machine by a thread of its own, and a host that speaks to it in bytes.

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>

#include <atomic>
#include <thread>

#include "drivers/file_descriptor.hpp"
#include "simulator/wire/served_bench.hpp"
#include "tests/simulator/test_bench.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fogbench::simulator {

/// The machine's clock, which a test can set ahead from its own thread.
class JumpingClock final : public drivers::Clock {
 public:
  Instant now() const override { return machine_.now() + Duration(ahead_ns_.load()); }
  WallTime wall_now() const override { return machine_.wall_now(); }
  void sleep_until(Instant deadline) override {
    machine_.sleep_until(deadline - Duration(ahead_ns_.load()));
  }
  /// To so many seconds after the beginning.
  void jump_to(double seconds) {
    ahead_ns_ = (drivers::from_seconds(seconds) - machine_.now().time_since_epoch()).count();
  }

 private:
  drivers::SteadyClock machine_;
  std::atomic<std::int64_t> ahead_ns_{0};
};

/// A connection to the bench; every wait is bounded.
class Wire {
 public:
  explicit Wire(std::uint16_t port) : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in where{};
    where.sin_family = AF_INET;
    where.sin_port = htons(port);
    where.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ =
        connect(socket_.get(), reinterpret_cast<const sockaddr*>(&where), sizeof where) == 0;
  }

  bool connected() const { return connected_; }
  int descriptor() const { return socket_.get(); }
  void send(ByteView bytes) {
    EXPECT_EQ(::send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(bytes.size()));
  }
  /// Exactly so many bytes; fewer when the bench closed the connection or is silent for `ms`.
  Bytes receive(std::size_t count, int ms = 5000) {
    Bytes out(count);
    std::size_t have = 0;
    while (have < count) {
      pollfd ready{socket_.get(), POLLIN, 0};
      if (poll(&ready, 1, ms) <= 0) break;
      const ssize_t got = recv(socket_.get(), out.data() + have, count - have, 0);
      if (got <= 0) break;
      have += static_cast<std::size_t>(got);
    }
    out.resize(have);
    return out;
  }
  /// The bench has closed the connection, at the latest after `ms`; what it still sent is dropped.
  bool closed(int ms = 5000) {
    Bytes some(4096);
    for (;;) {
      pollfd ready{socket_.get(), POLLIN, 0};
      if (poll(&ready, 1, ms) <= 0) return false;
      if (recv(socket_.get(), some.data(), some.size(), 0) <= 0) return true;
    }
  }

 private:
  drivers::FileDescriptor socket_;
  bool connected_ = false;
};

class ServedBenchTest : public testing::Test {
 protected:
  explicit ServedBenchTest(const config::ScenarioConfig& scenario = {},
                           const config::BenchConfig& config = numbered_bench()) {
    auto opened = ServedBench::open(config, scenario, 1, {.tty_folder = folder_.path()}, clock_);
    if (!opened) {
      ADD_FAILURE() << opened.error().message;
      return;
    }
    bench_ = *std::move(opened);
    thread_ = std::thread([this] { status_ = bench_->run(stop_.get()); });
  }
  ~ServedBenchTest() override {
    stop();
    EXPECT_TRUE(status_);
  }

  static config::BenchConfig numbered_bench() {
    config::BenchConfig bench = test_bench();
    bench.coil_horizontal.serial_number = "S-1";
    bench.coil_vertical.serial_number = "S-2";
    return bench;
  }

  void stop() {
    if (!thread_.joinable()) return;
    eventfd_write(stop_.get(), 1);
    thread_.join();
  }

  const ServedInstrument& instrument(const std::string& name) const {
    for (const ServedInstrument& one : bench_->instruments()) {
      if (one.name == name) return one;
    }
    ADD_FAILURE() << name;
    return bench_->instruments().front();
  }
  std::uint16_t modbus_port() const {
    const std::string& connection = instrument("thermostat").connection;
    return static_cast<std::uint16_t>(std::stoi(connection.substr(connection.rfind(':') + 1)));
  }

  support::TemporaryFolder folder_;
  JumpingClock clock_;
  drivers::FileDescriptor stop_{eventfd(0, EFD_CLOEXEC)};
  std::unique_ptr<ServedBench> bench_;
  Status status_;
  std::thread thread_;
};

}  // namespace fogbench::simulator
