// Our Modbus driver against pymodbus's server: only a program that is not ours shows that both of
// our ends do not share a mistake.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "config/device.hpp"
#include "config/device_file.hpp"
#include "drivers/modbus_port.hpp"
#include "drivers/modbus_thermostat.hpp"
#include "tests/support/process.hpp"
#include "tests/support/pty.hpp"
#include "tests/support/source_tree.hpp"

namespace fogbench::system_tests {
namespace {

using namespace std::chrono_literals;
using config::Celsius;
using config::HeatingMode;

/// The Debian package python3-pymodbus belongs to Debian's own Python.
std::vector<std::string> server(const std::string& kind, const std::string& where) {
  return {"/usr/bin/python3", (tests::source_tree() / "tests/system/pymodbus_server.py").string(),
          kind, where};
}

/// Two pseudo-terminals, byte by byte one line.
class Cable {
 public:
  ~Cable() {
    done_ = true;
    thread_.join();
  }
  const support::Pty& ours() const { return ours_; }
  const support::Pty& theirs() const { return theirs_; }

 private:
  void carry() {
    while (!done_) {
      pollfd ends[] = {{ours_.fd(), POLLIN, 0}, {theirs_.fd(), POLLIN, 0}};
      if (poll(ends, 2, 20) <= 0) continue;
      for (const int i : {0, 1}) {
        if ((ends[i].revents & POLLIN) == 0) {
          // An end that nobody has opened yet hangs up all the time.
          if (ends[i].revents != 0) poll(nullptr, 0, 5);
          continue;
        }
        std::uint8_t bytes[256];
        const ssize_t count = read(ends[i].fd, bytes, sizeof bytes);
        if (count > 0) (i == 0 ? theirs_ : ours_).send({bytes, static_cast<std::size_t>(count)});
      }
    }
  }
  support::Pty ours_, theirs_;
  std::atomic<bool> done_{false};
  std::thread thread_{[this] { carry(); }};
};

/// Python takes a second or more to start.
template <class Connection>
std::unique_ptr<drivers::ModbusThermostat> reach(const Connection& connection,
                                                 drivers::Clock& clock) {
  const auto device =
      config::load_device(tests::source_tree() / "config/devices/thermostat-eurotherm.json");
  EXPECT_TRUE(device) << device.error().message;
  const auto& modbus = std::get<config::ModbusDevice>(*device);
  std::string why;
  for (int tries = 0; tries < 100; ++tries) {
    auto port = drivers::open_modbus(connection, modbus.unit_id, clock);
    if (port) {
      auto thermostat = drivers::begun(
          drivers::ModbusThermostat::attach("thermostat", modbus, std::move(*port), clock));
      if (thermostat) return std::move(*thermostat);
      why = thermostat.error().message;
    } else {
      why = port.error().message;
    }
    clock.sleep_for(200ms);
  }
  ADD_FAILURE() << "pymodbus's server is not reached (is python3-pymodbus installed?): " << why;
  return nullptr;
}

void expect_understood(drivers::ModbusThermostat& thermostat) {
  const auto first = thermostat.read();
  ASSERT_TRUE(first) << first.error().message;
  EXPECT_EQ(first->working_1, Celsius{31.25});
  EXPECT_EQ(first->working_2, Celsius{31.75});
  EXPECT_EQ(first->control, Celsius{31.5});
  EXPECT_EQ(first->ambient, Celsius{21.0});
  EXPECT_EQ(first->mode, HeatingMode::kOff);
  const auto target = thermostat.set_target(Celsius{45.5});
  ASSERT_TRUE(target) << target.error().message;
  const auto mode = thermostat.set_mode(HeatingMode::kNormal);
  ASSERT_TRUE(mode) << mode.error().message;
  const auto then = thermostat.read();
  ASSERT_TRUE(then) << then.error().message;
  EXPECT_EQ(then->target, Celsius{45.5});
  EXPECT_EQ(then->mode, HeatingMode::kNormal);
}

void expect_refused(const Result<std::unique_ptr<drivers::ModbusTransport>>& port) {
  ASSERT_TRUE(port) << port.error().message;
  std::uint16_t word = 0;
  const auto refused = (*port)->read_registers(9999, {&word, 1});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kDevice);
  EXPECT_THAT(refused.error().message, testing::HasSubstr("Modbus exception 2"));
}

TEST(Pymodbus, UnderstandsOurDriverOverTcp) {
  // A port that was free a moment ago.
  const int probe = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof at;
  ASSERT_EQ(bind(probe, reinterpret_cast<sockaddr*>(&at), size), 0);
  ASSERT_EQ(getsockname(probe, reinterpret_cast<sockaddr*>(&at), &size), 0);
  close(probe);

  const config::TcpConnection connection{"127.0.0.1", ntohs(at.sin_port)};
  const support::Process process(server("tcp", std::to_string(connection.port)));
  drivers::SteadyClock clock;
  {
    const auto thermostat = reach(connection, clock);
    ASSERT_TRUE(thermostat);
    expect_understood(*thermostat);
  }
  expect_refused(drivers::open_modbus(connection, 1, clock));
}

TEST(Pymodbus, UnderstandsOurDriverOverRtu) {
  const Cable cable;
  const config::RtuConnection connection{cable.ours().path(), 19200};
  const support::Process process(server("rtu", cable.theirs().path()));
  drivers::SteadyClock clock;
  {
    const auto thermostat = reach(connection, clock);
    ASSERT_TRUE(thermostat);
    expect_understood(*thermostat);
  }
  expect_refused(drivers::open_modbus(connection, 1, clock));
}

}  // namespace
}  // namespace fogbench::system_tests
