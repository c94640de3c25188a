#pragma once
// USBTMC 1.0 and its USB488 subclass in bytes: the header of each bulk transfer, and the class
// requests' codes. Pure functions over bytes that may be anything.

#include <cstdint>
#include <optional>
#include <string_view>

#include "simulator/wire/bytes.hpp"

namespace fogbench::simulator {

inline constexpr std::size_t kUsbtmcHeaderBytes = 12;

enum class UsbtmcMessage : std::uint8_t {
  kMessageOut = 1,  ///< DEV_DEP_MSG_OUT
  kRequestIn = 2,   ///< REQUEST_DEV_DEP_MSG_IN, and the answer to it
};

struct UsbtmcHeader {
  UsbtmcMessage message = UsbtmcMessage::kMessageOut;
  std::uint8_t tag = 0;
  std::uint32_t size = 0;       ///< of the message, without header and padding
  bool end_of_message = false;  ///< of a message out
};

/// None for what is no header: too short, a tag of 0 or that its complement denies, a message that
/// this device does not know.
std::optional<UsbtmcHeader> parse_usbtmc_header(ByteView bytes);

/// The whole transfer that answers a request, padded to four bytes.
Bytes encode_usbtmc_answer(std::uint8_t tag, std::string_view text, bool end_of_message);

/// bRequest of USBTMC (table 15) and USB488 (table 9).
enum class UsbtmcRequest : std::uint8_t {
  kInitiateAbortOut = 1,
  kCheckAbortOut = 2,
  kInitiateAbortIn = 3,
  kCheckAbortIn = 4,
  kInitiateClear = 5,
  kCheckClear = 6,
  kGetCapabilities = 7,
  kReadStatusByte = 128,
};

enum class UsbtmcStatus : std::uint8_t {
  kSuccess = 0x01,
  kPending = 0x02,
  kFailed = 0x80,
  kNotInProgress = 0x81,
};

/// A USB488 device of SCPI; no trigger, no remote and local, no service requests.
Bytes usbtmc_capabilities();

}  // namespace fogbench::simulator
