#include "simulator/wire/modbus_protocol.hpp"

#include <fmt/format.h>

#include "drivers/crc.hpp"

namespace fogbench::simulator {
namespace {

// The standard's bounds of one request.
constexpr std::uint16_t kMostRead = 125;
constexpr std::uint16_t kMostWritten = 123;

constexpr std::size_t kTcpHeaderBytes = 7;
constexpr std::size_t kLongestContent = 253;

constexpr std::size_t kRtuCheckBytes = 2;
constexpr std::size_t kShortestRtu = 4;  // unit, function, check
constexpr std::size_t kFixedRtu = 8;     // of functions 3 and 6
constexpr std::size_t kWriteRtu = 9;     // of function 16, without the values

const drivers::Crc& rtu_crc() {
  static const drivers::Crc kCrc(config::CrcSpec{.width_bits = 16,
                                                 .polynomial = 0x8005,
                                                 .initial = 0xFFFF,
                                                 .final_xor = 0,
                                                 .reflected = true});
  return kCrc;
}

}  // namespace

ModbusParsed parse_modbus_request(ByteView bytes) {
  ModbusParsed parsed;
  ModbusRequest& request = parsed.request;
  const auto refuse = [&](std::uint8_t exception) {
    parsed.exception = exception;
    return parsed;
  };
  request.function = static_cast<ModbusFunction>(bytes[0]);
  switch (request.function) {
    case ModbusFunction::kReadRegisters:
    case ModbusFunction::kWriteRegister:
      if (bytes.size() != 5) return refuse(kIllegalValue);
      break;
    case ModbusFunction::kWriteRegisters:
      if (bytes.size() < 6 || bytes.size() != 6U + bytes[5]) return refuse(kIllegalValue);
      break;
    default:
      return refuse(kIllegalFunction);
  }
  request.address = be16_at(bytes, 1);
  const std::uint16_t word = be16_at(bytes, 3);
  if (request.function == ModbusFunction::kWriteRegister) {
    request.count = 1;
    request.values = {word};
    return parsed;
  }
  request.count = word;
  const bool writes = request.function == ModbusFunction::kWriteRegisters;
  if (word == 0 || word > (writes ? kMostWritten : kMostRead)) return refuse(kIllegalValue);
  if (writes && bytes[5] != 2 * word) return refuse(kIllegalValue);
  if (request.address + word > 0x10000) return refuse(kIllegalAddress);
  for (std::size_t i = 6; writes && i < bytes.size(); i += 2) {
    request.values.push_back(be16_at(bytes, i));
  }
  return parsed;
}

Bytes encode_modbus_answer(const ModbusRequest& request, const std::vector<std::uint16_t>& values) {
  Bytes out{static_cast<std::uint8_t>(request.function)};
  if (request.function == ModbusFunction::kReadRegisters) {
    out.push_back(static_cast<std::uint8_t>(2 * values.size()));
    for (const std::uint16_t value : values) append_be16(out, value);
    return out;
  }
  append_be16(out, request.address);
  const bool one = request.function == ModbusFunction::kWriteRegister;
  append_be16(out, one ? request.values.front() : request.count);
  return out;
}

Bytes encode_modbus_exception(std::uint8_t function, std::uint8_t exception) {
  return {static_cast<std::uint8_t>(function | 0x80U), exception};
}

Result<std::optional<ModbusFrame>> parse_modbus_tcp(ByteView bytes) {
  if (bytes.size() < kTcpHeaderBytes) return std::optional<ModbusFrame>();
  const std::uint16_t protocol = be16_at(bytes, 2);
  const std::uint16_t length = be16_at(bytes, 4);  // of the unit and the content
  if (protocol != 0 || length < 2 || length > kLongestContent + 1) {
    return Error{ErrorCode::kProtocol,
                 fmt::format("protocol {}, length {}; expected protocol 0, length 2 to {}",
                             protocol, length, kLongestContent + 1)};
  }
  ModbusFrame frame;
  frame.size = kTcpHeaderBytes - 1 + length;
  if (bytes.size() < frame.size) return std::optional<ModbusFrame>();
  frame.transaction = be16_at(bytes, 0);
  frame.unit = bytes[6];
  frame.content.assign(bytes.begin() + kTcpHeaderBytes,
                       bytes.begin() + static_cast<std::ptrdiff_t>(frame.size));
  return std::optional(std::move(frame));
}

Bytes encode_modbus_tcp(std::uint16_t transaction, std::uint8_t unit, ByteView content) {
  Bytes out;
  append_be16(out, transaction);
  append_be16(out, 0);
  append_be16(out, static_cast<std::uint16_t>(content.size() + 1));
  out.push_back(unit);
  append(out, content);
  return out;
}

std::optional<std::size_t> modbus_rtu_request_size(ByteView bytes) {
  if (bytes.size() < 2) return std::nullopt;
  switch (static_cast<ModbusFunction>(bytes[1])) {
    case ModbusFunction::kReadRegisters:
    case ModbusFunction::kWriteRegister:
      return kFixedRtu;
    case ModbusFunction::kWriteRegisters:
      if (bytes.size() < 7) return std::nullopt;
      return kWriteRtu + bytes[6];
  }
  return std::nullopt;
}

std::optional<ModbusFrame> parse_modbus_rtu(ByteView bytes) {
  if (bytes.size() < kShortestRtu) return std::nullopt;
  const ByteView checked = bytes.first(bytes.size() - kRtuCheckBytes);
  // The check value is sent low byte first.
  if (rtu_crc().of(checked) != le16_at(bytes, checked.size())) return std::nullopt;
  return ModbusFrame{.transaction = 0,
                     .unit = bytes[0],
                     .content = Bytes(checked.begin() + 1, checked.end()),
                     .size = bytes.size()};
}

Bytes encode_modbus_rtu(std::uint8_t unit, ByteView content) {
  Bytes out{unit};
  append(out, content);
  append_le16(out, static_cast<std::uint16_t>(rtu_crc().of(out)));
  return out;
}

}  // namespace fogbench::simulator
