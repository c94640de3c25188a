#include "drivers/modbus_messages.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace fogbench::drivers::modbus {
namespace {

constexpr std::uint8_t kReadHoldingRegisters = 3;
constexpr std::uint8_t kWriteMultipleRegisters = 16;
/// Added to the function of a request that is answered with an exception.
constexpr std::uint8_t kExceptionBit = 0x80;

void put_word(Bytes& bytes, std::size_t word) {
  bytes.push_back(static_cast<std::uint8_t>(word >> 8));
  bytes.push_back(static_cast<std::uint8_t>(word));
}

std::uint16_t word_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] << 8 | bytes[at + 1]);
}

Bytes encode_head(std::uint8_t unit, std::uint8_t function, std::uint16_t address,
                  std::size_t count) {
  Bytes bytes{unit, function};
  put_word(bytes, address);
  put_word(bytes, count);
  return bytes;
}

struct Exception {
  std::uint8_t code;
  const char* meaning;
  bool is_transient;  ///< the same request may be taken a little later
};
/// Application protocol, section 7. "Acknowledge" means that it is at work on the request; a
/// gateway without a path is one that is misconfigured or overloaded.
constexpr Exception kExceptions[] = {
    {1, "illegal function", false},          {2, "illegal data address", false},
    {3, "illegal data value", false},        {4, "device failure", false},
    {5, "acknowledge, still at work", true}, {6, "device busy", true},
    {7, "negative acknowledge", false},      {8, "memory parity error", false},
    {10, "gateway path unavailable", true},  {11, "gateway target does not answer", true}};

Error no_answer(const std::string& what) {
  return {ErrorCode::kProtocol, what};
}

}  // namespace

Bytes encode_read(std::uint8_t unit, std::uint16_t address, std::size_t count) {
  return encode_head(unit, kReadHoldingRegisters, address, count);
}

Bytes encode_write(std::uint8_t unit, std::uint16_t address,
                   std::span<const std::uint16_t> values) {
  Bytes bytes = encode_head(unit, kWriteMultipleRegisters, address, values.size());
  bytes.push_back(static_cast<std::uint8_t>(2 * values.size()));
  for (const std::uint16_t value : values) put_word(bytes, value);
  return bytes;
}

std::size_t register_count(const Bytes& request) {
  return word_at(request, 4);
}

Bytes encode_tcp(std::uint16_t transaction, const Bytes& request) {
  Bytes bytes;
  put_word(bytes, transaction);
  put_word(bytes, 0);
  put_word(bytes, request.size());
  bytes.insert(bytes.end(), request.begin(), request.end());
  return bytes;
}

Result<Bytes> decode_tcp(std::uint16_t transaction, std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kTcpHeaderBytes) {
    return no_answer(fmt::format("answers {} bytes", bytes.size()));
  }
  if (word_at(bytes, 0) != transaction || word_at(bytes, 2) != 0) {
    return no_answer(
        fmt::format("an answer to transaction {}, protocol {}, asked as transaction "
                    "{}, protocol 0",
                    word_at(bytes, 0), word_at(bytes, 2), transaction));
  }
  return Bytes(bytes.begin() + kTcpHeaderBytes, bytes.end());
}

Status check_answer(const Bytes& request, const Bytes& answer) {
  constexpr std::size_t kExceptionBytes = 3;
  if (answer.size() < kExceptionBytes) {
    return no_answer(fmt::format("answers {} bytes", answer.size()));
  }
  if (answer[0] != request[0]) {
    return no_answer(
        fmt::format("an answer of unit {} to a request to unit {}", answer[0], request[0]));
  }
  if (answer[1] == (request[1] | kExceptionBit) && answer.size() == kExceptionBytes) return {};
  if (answer[1] != request[1]) {
    return no_answer(
        fmt::format("an answer to function {}, asked for function {}", answer[1], request[1]));
  }
  if (request[1] == kReadHoldingRegisters) {
    const std::size_t count = register_count(request);
    if (answer[2] == 2 * count && answer.size() == 3 + 2 * count) return {};
    return no_answer(fmt::format("an answer with {} bytes of registers, asked for {} registers",
                                 answer[2], count));
  }
  // Unit, function, address and count come back.
  constexpr std::size_t kWrittenBytes = 6;
  if (answer.size() == kWrittenBytes && std::equal(answer.begin(), answer.end(), request.begin())) {
    return {};
  }
  return no_answer("an answer about other registers than were written");
}

Status exception_in(const Bytes& answer) {
  if ((answer[1] & kExceptionBit) == 0) return {};
  const std::uint8_t code = answer[2];
  const auto known = std::find_if(std::begin(kExceptions), std::end(kExceptions),
                                  [code](const Exception& e) { return e.code == code; });
  if (known == std::end(kExceptions)) {
    return Error{ErrorCode::kDevice, fmt::format("Modbus exception {}", code)};
  }
  return Error{known->is_transient ? ErrorCode::kBusy : ErrorCode::kDevice,
               fmt::format("Modbus exception {} ({})", code, known->meaning)};
}

void take_registers(const Bytes& answer, std::span<std::uint16_t> out) {
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = word_at(answer, 3 + 2 * i);
}

}  // namespace fogbench::drivers::modbus
