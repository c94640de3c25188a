#include "drivers/usbtmc_messages.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "drivers/number_codec.hpp"

namespace fogbench::drivers::usbtmc {
namespace {

constexpr std::uint8_t kEndOfMessage = 0x01;

std::array<std::uint8_t, kHeaderBytes> header(MessageId id, std::uint8_t tag, std::uint32_t size,
                                              std::uint8_t attributes) {
  std::array<std::uint8_t, kHeaderBytes> bytes{};
  bytes[0] = id;
  bytes[1] = tag;
  bytes[2] = static_cast<std::uint8_t>(~tag);
  store_bytes(bytes.data() + 4, 4, ByteOrder::kLittleEndian, size);
  bytes[8] = attributes;
  return bytes;
}

}  // namespace

std::vector<std::uint8_t> encode_message(std::uint8_t tag, std::string_view message) {
  const auto head =
      header(kDevDepMsgOut, tag, static_cast<std::uint32_t>(message.size()), kEndOfMessage);
  std::vector<std::uint8_t> bytes((kHeaderBytes + message.size() + 3) / 4 * 4);
  std::copy(head.begin(), head.end(), bytes.begin());
  std::copy(message.begin(), message.end(), bytes.begin() + kHeaderBytes);
  return bytes;
}

std::array<std::uint8_t, kHeaderBytes> encode_request(std::uint8_t tag, std::uint32_t most) {
  return header(kRequestDevDepMsgIn, tag, most, 0);
}

Result<AnswerHeader> decode_answer_header(std::span<const std::uint8_t> bytes, std::uint32_t most) {
  if (bytes.size() < kHeaderBytes) {
    return Error{ErrorCode::kProtocol, fmt::format("an answer of {} bytes, expected a header of {}",
                                                   bytes.size(), kHeaderBytes)};
  }
  if (bytes[0] != kDevDepMsgIn) {
    return Error{ErrorCode::kProtocol,
                 fmt::format("an answer of kind {}, expected {}", bytes[0], +kDevDepMsgIn)};
  }
  if (bytes[1] == 0 || bytes[2] != static_cast<std::uint8_t>(~bytes[1])) {
    return Error{
        ErrorCode::kProtocol,
        fmt::format("an answer with the tag {} and its complement {}", bytes[1], bytes[2])};
  }
  const std::uint32_t size = load_bytes(bytes.data() + 4, 4, ByteOrder::kLittleEndian);
  if (size > most) {
    return Error{ErrorCode::kProtocol,
                 fmt::format("an answer of {} bytes, asked for at most {}", size, most)};
  }
  return AnswerHeader{bytes[1], size, (bytes[8] & kEndOfMessage) != 0};
}

}  // namespace fogbench::drivers::usbtmc
