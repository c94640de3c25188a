#include "config/connection.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace fogbench::config {
namespace {

using testing::HasSubstr;

template <class Wanted>
Wanted parsed(const char* text) {
  const auto connection = parse_connection(text);
  EXPECT_TRUE(connection) << connection.error().message;
  if (!connection || !std::holds_alternative<Wanted>(*connection)) {
    ADD_FAILURE() << text << " is of another kind";
    return {};
  }
  return std::get<Wanted>(*connection);
}

TEST(Connection, SimulatedIsAWordOfItsOwn) {
  parsed<SimulatedConnection>("simulated");
}

TEST(Connection, ModbusTcpHasHostAndPort) {
  const auto tcp = parsed<TcpConnection>("tcp:192.168.1.5:502");
  EXPECT_EQ(tcp.host, "192.168.1.5");
  EXPECT_EQ(tcp.port, 502);
  EXPECT_EQ(parsed<TcpConnection>("tcp:[::1]:1502").host, "::1");
}

TEST(Connection, ModbusRtuHasALineARateAndMayHaveAFormat) {
  const auto plain = parsed<RtuConnection>("rtu:/dev/ttyUSB0:9600");
  EXPECT_EQ(plain.tty, "/dev/ttyUSB0");
  EXPECT_EQ(plain.baud, 9600U);
  EXPECT_EQ(plain.parity, 'N');
  EXPECT_EQ(plain.stop_bits, 1);
  const auto even = parsed<RtuConnection>("rtu:/dev/serial/by-path/pci-0:14:19200:8E1");
  EXPECT_EQ(even.tty, "/dev/serial/by-path/pci-0:14");
  EXPECT_EQ(even.baud, 19200U);
  EXPECT_EQ(even.parity, 'E');
  EXPECT_EQ(parsed<RtuConnection>("rtu:/dev/ttyS0:1200:8N2").stop_bits, 2);
  EXPECT_FALSE(even.echoes);
  for (const char* text : {"rtu:/dev/ttyS0:1200:echo", "rtu:/dev/ttyS0:1200:8E1:echo"}) {
    const auto echoing = parsed<RtuConnection>(text);
    EXPECT_TRUE(echoing.echoes);
    EXPECT_EQ(echoing.tty, "/dev/ttyS0");
    EXPECT_EQ(echoing.baud, 1200U);
  }
}

TEST(Connection, UsbAndHidAreChosenByTheirSerialNumber) {
  const auto usb = parsed<UsbConnection>("usb:0x0957:0x1234:BOP:0001");
  EXPECT_EQ(usb.vendor, 0x0957);
  EXPECT_EQ(usb.product, 0x1234);
  EXPECT_EQ(usb.serial, "BOP:0001");
  const auto hid = parsed<HidConnection>("hid:1209:0001:MAG0042");
  EXPECT_EQ(hid.vendor, 0x1209);
  EXPECT_EQ(hid.product, 0x0001);
  EXPECT_EQ(hid.serial, "MAG0042");
}

TEST(Connection, ASerialLineMayNameItsRate) {
  EXPECT_FALSE(parsed<TtyConnection>("tty:/dev/ttyUSB1").baud);
  EXPECT_EQ(parsed<TtyConnection>("tty:/dev/ttyUSB1:1843200").baud, 1843200U);
  const auto by_path =
      parsed<TtyConnection>("tty:/dev/serial/by-path/pci-0000:00:14.0-usb-0:1:1.0");
  EXPECT_EQ(by_path.tty, "/dev/serial/by-path/pci-0000:00:14.0-usb-0:1:1.0");
}

TEST(Connection, WhatIsWrongIsSaidWithWhatWasExpected) {
  for (const auto& [text, expected] : std::initializer_list<std::pair<const char*, const char*>>{
           {"", "expected \"simulated\", or"},
           {"Simulated", "expected \"simulated\", or"},
           {"udp:1.2.3.4:5", "starts with tcp:"},
           {"tcp:", "expected tcp:ADDRESS:PORT"},
           {"tcp:10.0.0.1", "expected tcp:ADDRESS:PORT"},
           {"tcp:10.0.0.1:", "expected tcp:ADDRESS:PORT"},
           {"tcp::502", "expected tcp:ADDRESS:PORT"},
           {"tcp:thermostat.local:502", "looking up a name has no deadline"},
           {"tcp:10.0.0.1:0", "expected tcp:ADDRESS:PORT"},
           {"tcp:10.0.0.1:65536", "expected tcp:ADDRESS:PORT"},
           {"tcp:10.0.0.1:502x", "expected tcp:ADDRESS:PORT"},
           {"rtu:/dev/ttyUSB0", "expected rtu:TTY:BAUD"},
           {"rtu:/dev/ttyUSB0:9601", "standard rate"},
           {"rtu:ttyUSB0:9600", "expected rtu:TTY:BAUD"},
           {"rtu:/dev/ttyUSB0:9600:8X1", "expected rtu:TTY:BAUD"},
           {"rtu:/dev/ttyUSB0:9600:7E1", "expected rtu:TTY:BAUD"},
           {"rtu:8N1", "expected rtu:TTY:BAUD"},
           {"rtu:/dev/ttyUSB0:9600:echo:8N1", "expected rtu:TTY:BAUD"},
           {"rtu:/dev/ttyUSB0:9600:Echo", "expected rtu:TTY:BAUD"},
           {"usb:0x0957:0x1234", "expected usb:VENDOR:PRODUCT:SERIAL"},
           {"usb:0x0957:0x1234:", "expected usb:VENDOR:PRODUCT:SERIAL"},
           {"usb:0x10957:0x1234:S", "expected usb:VENDOR:PRODUCT:SERIAL"},
           {"usb:0xZZ:0x1234:S", "expected usb:VENDOR:PRODUCT:SERIAL"},
           {"hid:::", "expected hid:VENDOR:PRODUCT:SERIAL"},
           {"tty:ttyUSB1", "expected tty:TTY"},
           {"tty:/dev/ttyUSB1:0", "expected tty:TTY"},
           {"tty:/dev/ttyUSB1:99999999", "expected tty:TTY"},
           {"tty:/dev/ttyUSB1:", "expected tty:TTY"}}) {
    const auto connection = parse_connection(text);
    ASSERT_FALSE(connection) << text;
    EXPECT_EQ(connection.error().code, ErrorCode::kBadInput);
    EXPECT_THAT(connection.error().message, HasSubstr(std::string("found \"") + text + "\""));
    EXPECT_THAT(connection.error().message, HasSubstr(expected)) << text;
  }
}

}  // namespace
}  // namespace fogbench::config
