#include "config/connection.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "config/json_file.hpp"

namespace fogbench::config {
namespace {

/// What termios has a constant for, and every Modbus instrument offers some of.
constexpr std::array<std::uint32_t, 12> kModbusBauds = {
    1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200, 230400, 460800, 500000, 921600};
constexpr std::uint32_t kHighestBaud = 12'000'000;  ///< of the fastest USB adapters

template <class Integer>
std::optional<Integer> parse_number(std::string_view text, int base = 10) {
  if (base == 16 && (text.starts_with("0x") || text.starts_with("0X"))) text.remove_prefix(2);
  Integer value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Takes what stands behind the last colon off `text`; none when there is no colon.
std::optional<std::string_view> take_last(std::string_view& text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos) return std::nullopt;
  const std::string_view last = text.substr(colon + 1);
  text = text.substr(0, colon);
  return last;
}

std::optional<TcpConnection> parse_tcp(std::string_view rest) {
  const auto port = take_last(rest);
  if (!port) return std::nullopt;
  const auto number = parse_number<std::uint16_t>(*port);
  if (rest.starts_with('[') && rest.ends_with(']')) rest = rest.substr(1, rest.size() - 2);
  std::string host(rest);
  std::array<unsigned char, sizeof(in6_addr)> address;
  const bool numeric = inet_pton(AF_INET, host.c_str(), address.data()) == 1 ||
                       inet_pton(AF_INET6, host.c_str(), address.data()) == 1;
  if (!number || *number == 0 || !numeric) return std::nullopt;
  return TcpConnection{std::move(host), *number};
}

std::optional<RtuConnection> parse_rtu(std::string_view rest) {
  RtuConnection rtu;
  auto last = take_last(rest);
  if (last == "echo") {
    rtu.echoes = true;
    last = take_last(rest);
  }
  if (last && last->size() == 3 && last->front() == '8') {
    rtu.parity = (*last)[1];
    rtu.stop_bits = (*last)[2] - '0';
    if (*last != "8N1" && *last != "8E1" && *last != "8O1" && *last != "8N2") return std::nullopt;
    last = take_last(rest);
  }
  const auto baud = last ? parse_number<std::uint32_t>(*last) : std::nullopt;
  if (!baud || !rest.starts_with('/')) return std::nullopt;
  if (std::find(kModbusBauds.begin(), kModbusBauds.end(), *baud) == kModbusBauds.end()) {
    return std::nullopt;
  }
  rtu.tty = rest;
  rtu.baud = *baud;
  return rtu;
}

std::optional<UsbIdentity> parse_usb(std::string_view rest) {
  // A serial number may hold colons.
  const std::size_t first = rest.find(':');
  const std::size_t second =
      first == std::string_view::npos ? std::string_view::npos : rest.find(':', first + 1);
  if (second == std::string_view::npos || second + 1 == rest.size()) return std::nullopt;
  const auto vendor = parse_number<std::uint16_t>(rest.substr(0, first), 16);
  const auto product = parse_number<std::uint16_t>(rest.substr(first + 1, second - first - 1), 16);
  if (!vendor || !product) return std::nullopt;
  return UsbIdentity{*vendor, *product, std::string(rest.substr(second + 1))};
}

std::optional<TtyConnection> parse_tty(std::string_view rest) {
  TtyConnection tty;
  // The names in /dev/serial/by-path hold colons, but none ends with a number behind one.
  std::string_view path = rest;
  if (const auto last = take_last(path)) {
    if (const auto baud = parse_number<std::uint32_t>(*last)) {
      if (*baud == 0 || *baud > kHighestBaud) return std::nullopt;
      tty.baud = *baud;
      rest = path;
    }
  }
  if (!rest.starts_with('/') || rest.ends_with(':')) return std::nullopt;
  tty.tty = rest;
  return tty;
}

template <class Wanted, class Parsed>
Result<Connection> made(std::string_view text, const std::optional<Parsed>& parsed,
                        std::string_view expected) {
  if (parsed) return Connection{Wanted{*parsed}};
  return Error{ErrorCode::kBadInput,
               fmt::format("found \"{}\", expected {}", one_line(text), expected)};
}

}  // namespace

Result<Connection> parse_connection(std::string_view text) {
  if (text == "simulated") return Connection{SimulatedConnection{}};
  const std::string_view scheme = text.substr(0, text.find(':') + 1);
  const std::string_view rest = text.substr(scheme.size());
  if (scheme == "tcp:") {
    return made<TcpConnection>(
        text, parse_tcp(rest),
        "tcp:ADDRESS:PORT, such as tcp:192.168.1.5:502, with an address in numbers: looking up a "
        "name has no deadline");
  }
  if (scheme == "rtu:") {
    return made<RtuConnection>(
        text, parse_rtu(rest),
        "rtu:TTY:BAUD or rtu:TTY:BAUD:8E1, such as rtu:/dev/ttyUSB0:9600, with a standard rate, "
        "and :echo behind it for an adapter that echoes");
  }
  if (scheme == "usb:") {
    return made<UsbConnection>(text, parse_usb(rest),
                               "usb:VENDOR:PRODUCT:SERIAL, such as usb:0x0957:0x1234:BOP0001");
  }
  if (scheme == "hid:") {
    return made<HidConnection>(text, parse_usb(rest),
                               "hid:VENDOR:PRODUCT:SERIAL, such as hid:0x1209:0x0001:MAG0042");
  }
  if (scheme == "tty:") {
    return made<TtyConnection>(
        text, parse_tty(rest),
        "tty:TTY or tty:TTY:BAUD, such as tty:/dev/ttyUSB1, with a path from the root");
  }
  return made<SimulatedConnection>(
      text, std::optional<SimulatedConnection>(),
      "\"simulated\", or an address that starts with tcp:, rtu:, usb:, hid: or tty:");
}

}  // namespace fogbench::config
