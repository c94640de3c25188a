#include "drivers/open_ports.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <vector>

#include "tests/support/own_locks.hpp"
#include "tests/support/pty.hpp"

namespace fogbench::drivers {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::StartsWith;

class OpenPortsTest : public testing::Test {
 protected:
  OpenPortsTest() {
    config_.coil_horizontal.connection = "tty:" + supply_1_.path();
    config_.coil_vertical.connection = "tty:" + supply_2_.path();
    config_.thermostat.connection = "rtu:" + thermostat_.path() + ":9600";
    config_.magnetometer.connection = "hid:0xFFF0:0x0001:NO-SUCH-MAGNETOMETER";
    config_.gyro.connection = "tty:" + gyro_.path();
  }
  std::string failure() {
    const auto ports = open_ports(config_, clock_);
    if (ports) return "opened";
    code_ = ports.error().code;
    return ports.error().message;
  }

  support::OwnLocks locks_;
  support::Pty supply_1_, supply_2_, thermostat_, gyro_;
  config::BenchConfig config_;
  VirtualClock clock_;
  ErrorCode code_ = ErrorCode::kUsage;
};

TEST_F(OpenPortsTest, AMissingInstrumentKeepsNobodyFromTheOthersAndSaysWhatWasLookedFor) {
  config_.coil_vertical.connection = "usb:0xFFF0:0x0002:NO-SUCH-SUPPLY";
  config_.thermostat.connection = "rtu:/dev/no-such-line:9600";
  const auto ports = open_ports(config_, clock_);
  ASSERT_TRUE(ports) << ports.error().message;
  EXPECT_TRUE(ports->coil_horizontal->write("CURR 0"));

  const auto why = [](const auto& result) {
    if (result) return std::string("reached");
    EXPECT_EQ(result.error().code, ErrorCode::kUnplugged);
    return result.error().message;
  };
  std::vector<std::uint8_t> report(16);
  EXPECT_THAT(why(ports->magnetometer->read_report(report, 0s)),
              StartsWith("HID device 0xfff0:0x0001 with the serial number NO-SUCH-MAGNETOMETER is "
                         "not there"));
  EXPECT_THAT(why(ports->coil_vertical->write("CURR 0")), HasSubstr("NO-SUCH-SUPPLY"));
  std::vector<std::uint16_t> words(1);
  EXPECT_THAT(why(ports->thermostat->read_registers(0, words)),
              StartsWith("cannot open /dev/no-such-line"));
}

TEST_F(OpenPortsTest, ASimulatedInstrumentOnARealBenchIsBadInput) {
  for (config::InstrumentConfig* simulated :
       {static_cast<config::InstrumentConfig*>(&config_.thermostat),
        static_cast<config::InstrumentConfig*>(&config_.coil_vertical),
        static_cast<config::InstrumentConfig*>(&config_.magnetometer)}) {
    const std::string before = std::exchange(simulated->connection, "simulated");
    EXPECT_THAT(failure(), HasSubstr("connection: found \"simulated\", expected "));
    EXPECT_EQ(code_, ErrorCode::kBadInput);
    simulated->connection = before;
  }
}

TEST_F(OpenPortsTest, AConnectionThatCannotBeReadIsBadInput) {
  config_.coil_horizontal.connection = "usb:1234";
  EXPECT_THAT(failure(),
              HasSubstr("coil_horizontal: connection: found \"usb:1234\", expected usb:VENDOR"));
  EXPECT_EQ(code_, ErrorCode::kBadInput);
}

}  // namespace
}  // namespace fogbench::drivers
