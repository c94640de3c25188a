#pragma once
// The bytes of USBTMC 1.0 (USB Test and Measurement Class, 2003) and its subclass USB488. Pure
// functions over spans; whatever arrives, they neither read past it nor fail to end.
//
// A bulk message begins with twelve bytes, little-endian, and is padded to a multiple of four:
//
//   0      1     2       3   4 ... 7         8            9 ... 11
//   MsgID  bTag  ~bTag   0   TransferSize    attributes   0
//
// bTag counts 1 ... 255: an answer carries the tag of its request.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "config/result.hpp"

namespace fogbench::drivers::usbtmc {

inline constexpr std::size_t kHeaderBytes = 12;

enum MessageId : std::uint8_t { kDevDepMsgOut = 1, kRequestDevDepMsgIn = 2, kDevDepMsgIn = 2 };

/// bRequest of the control requests (table 15; READ_STATUS_BYTE is of USB488, table 9).
enum Request : std::uint8_t {
  kInitiateAbortBulkOut = 1,
  kCheckAbortBulkOutStatus = 2,
  kInitiateAbortBulkIn = 3,
  kCheckAbortBulkInStatus = 4,
  kInitiateClear = 5,
  kCheckClearStatus = 6,
  kGetCapabilities = 7,
  kReadStatusByte = 128,
};

/// The first byte of every control answer (table 16).
enum ControlStatus : std::uint8_t {
  kSuccess = 0x01,
  kPending = 0x02,
  kFailed = 0x80,
  kTransferNotInProgress = 0x81,
};

/// A whole DEV_DEP_MSG_OUT with its end marked, padded.
std::vector<std::uint8_t> encode_message(std::uint8_t tag, std::string_view message);
/// Asks for at most `most` bytes of an answer.
std::array<std::uint8_t, kHeaderBytes> encode_request(std::uint8_t tag, std::uint32_t most);

/// What stands in front of an answer.
struct AnswerHeader {
  std::uint8_t tag = 0;
  std::uint32_t size = 0;  ///< bytes that follow, without padding
  bool is_last = false;    ///< of its message: the end is marked
};
/// kProtocol when it is too short, of another kind, contradicts itself, or announces more than the
/// `most` bytes that were asked for.
Result<AnswerHeader> decode_answer_header(std::span<const std::uint8_t> bytes, std::uint32_t most);

/// 1 after 255: 0 is no tag.
constexpr std::uint8_t next_tag(std::uint8_t tag) {
  return tag == 255 ? std::uint8_t{1} : static_cast<std::uint8_t>(tag + 1);
}
/// READ_STATUS_BYTE has tags of its own, 2 ... 127.
constexpr std::uint8_t next_status_tag(std::uint8_t tag) {
  return tag >= 127 || tag < 2 ? std::uint8_t{2} : static_cast<std::uint8_t>(tag + 1);
}

}  // namespace fogbench::drivers::usbtmc
