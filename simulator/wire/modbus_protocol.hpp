#pragma once
// Modbus in bytes (Modbus application protocol 1.1b3; TCP: messaging guide 1.0b; RTU: serial line
// 1.02): requests for holding registers taken apart, answers put together. Pure functions over
// bytes that may be anything.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "config/result.hpp"
#include "simulator/modbus_exception.hpp"
#include "simulator/wire/bytes.hpp"

namespace fogbench::simulator {

enum class ModbusFunction : std::uint8_t {
  kReadRegisters = 3,
  kWriteRegister = 6,
  kWriteRegisters = 16,
};

/// A request without its framing.
struct ModbusRequest {
  ModbusFunction function = ModbusFunction::kReadRegisters;
  std::uint16_t address = 0;
  std::uint16_t count = 0;
  std::vector<std::uint16_t> values;  ///< to be written
};

/// The request in these bytes, function code first; or the exception that answers it. Precondition:
/// there is at least one byte.
struct ModbusParsed {
  ModbusRequest request;
  std::uint8_t exception = 0;  ///< 0: `request` is whole and within the standard's bounds
};
ModbusParsed parse_modbus_request(ByteView bytes);

/// The answer to `request` without framing; `values` are those read.
Bytes encode_modbus_answer(const ModbusRequest& request, const std::vector<std::uint16_t>& values);
Bytes encode_modbus_exception(std::uint8_t function, std::uint8_t exception);

/// One frame's content, and who is meant.
struct ModbusFrame {
  std::uint16_t transaction = 0;  ///< TCP only
  std::uint8_t unit = 0;
  Bytes content;         ///< function code first
  std::size_t size = 0;  ///< bytes that the frame took
};

/// The first frame; none while it is incomplete. kProtocol for what is no Modbus TCP: the
/// connection is of no more use.
Result<std::optional<ModbusFrame>> parse_modbus_tcp(ByteView bytes);
Bytes encode_modbus_tcp(std::uint16_t transaction, std::uint8_t unit, ByteView content);

/// Bytes that the request at the beginning of `bytes` has with its check, as far as its function is
/// known; none while they are too few to say, or when silence must end it.
std::optional<std::size_t> modbus_rtu_request_size(ByteView bytes);
/// A whole frame; none when it is too short or its check value is wrong.
std::optional<ModbusFrame> parse_modbus_rtu(ByteView bytes);
Bytes encode_modbus_rtu(std::uint8_t unit, ByteView content);

}  // namespace fogbench::simulator
