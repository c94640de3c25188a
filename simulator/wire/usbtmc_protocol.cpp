#include "simulator/wire/usbtmc_protocol.hpp"

namespace fogbench::simulator {
namespace {

constexpr std::uint8_t kEndOfMessage = 0x01;

}  // namespace

std::optional<UsbtmcHeader> parse_usbtmc_header(ByteView bytes) {
  if (bytes.size() < kUsbtmcHeaderBytes) return std::nullopt;
  const std::uint8_t message = bytes[0];
  const bool known = message == static_cast<std::uint8_t>(UsbtmcMessage::kMessageOut) ||
                     message == static_cast<std::uint8_t>(UsbtmcMessage::kRequestIn);
  const bool tagged = bytes[1] != 0 && (bytes[1] ^ bytes[2]) == 0xFF;
  if (!known || !tagged) return std::nullopt;
  return UsbtmcHeader{.message = static_cast<UsbtmcMessage>(message),
                      .tag = bytes[1],
                      .size = le32_at(bytes, 4),
                      .end_of_message = (bytes[8] & kEndOfMessage) != 0};
}

Bytes encode_usbtmc_answer(std::uint8_t tag, std::string_view text, bool end_of_message) {
  Bytes out{static_cast<std::uint8_t>(UsbtmcMessage::kRequestIn), tag,
            static_cast<std::uint8_t>(~tag), 0};
  append_le32(out, static_cast<std::uint32_t>(text.size()));
  append_le32(out, end_of_message ? kEndOfMessage : 0);
  out.insert(out.end(), text.begin(), text.end());
  out.resize((out.size() + 3) / 4 * 4);
  return out;
}

Bytes usbtmc_capabilities() {
  Bytes out{static_cast<std::uint8_t>(UsbtmcStatus::kSuccess), 0};
  append_le16(out, 0x0100);  // bcdUSBTMC; no indicator pulse, talks and listens, no TermChar
  out.resize(12);
  append_le16(out, 0x0100);  // bcdUSB488
  out.push_back(0x04);       // an IEEE 488.2 USB488 interface
  out.push_back(0x08);       // understands SCPI
  out.resize(24);
  return out;
}

}  // namespace fogbench::simulator
