#pragma once
// Where an instrument is connected, as a bench file says it:
//
//   simulated                              the simulated bench, in memory
//   tcp:ADDRESS:PORT                       Modbus TCP
//   rtu:TTY:BAUD[:8N1][:echo]              Modbus RTU; 8E1, 8O1 and 8N2 are the other formats.
//                                          echo: the adapter hears what it sends itself
//   usb:VENDOR:PRODUCT:SERIAL              a USBTMC instrument, by its serial number
//   hid:VENDOR:PRODUCT:SERIAL              a HID instrument, by its serial number
//   tty:TTY[:BAUD]                         a serial line, 8N1
//
// ADDRESS is in numbers, 192.168.1.5 or [fd00::5]: nobody can say how long a look-up of a name
// takes, and a bench whose thermostat is gone must know within its deadline. VENDOR and PRODUCT are
// hexadecimal, "0x0957". A TTY is an absolute path; the names in /dev/serial/by-id stay with the
// adapter wherever it is plugged in.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "config/result.hpp"

namespace fogbench::config {

struct SimulatedConnection {};

struct TcpConnection {
  std::string host;
  std::uint16_t port = 0;
};

/// Whether somebody with this address may answer on a serial line. 0 is everybody, who stay silent;
/// those above 247 are reserved (Modbus over serial line V1.02, 2.2).
constexpr bool is_unit_of_serial_line(std::uint8_t unit) {
  return unit >= 1 && unit <= 247;
}

struct RtuConnection {
  std::string tty;
  std::uint32_t baud = 0;
  char parity = 'N';  ///< N, E or O
  int stop_bits = 1;
  bool echoes = false;  ///< what is sent comes back before the answer
};

/// The ids alone never choose a device: two supplies of one make have the same.
struct UsbIdentity {
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  std::string serial;
};
struct UsbConnection : UsbIdentity {};
struct HidConnection : UsbIdentity {};

struct TtyConnection {
  std::string tty;
  std::optional<std::uint32_t> baud;  ///< none: as the device file says
};

using Connection = std::variant<SimulatedConnection, TcpConnection, RtuConnection, UsbConnection,
                                HidConnection, TtyConnection>;

/// kBadInput says what was found and what was expected; the caller says where.
Result<Connection> parse_connection(std::string_view text);

}  // namespace fogbench::config
