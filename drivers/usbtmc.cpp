#include "drivers/usbtmc.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>

namespace fogbench::drivers {
namespace {

using namespace std::chrono_literals;
using namespace usbtmc;  // NOLINT(google-build-using-namespace): this file's vocabulary
using Recipient = UsbBulk::Recipient;

/// Asked for at once; SCPI answers of single values are far shorter.
constexpr std::uint32_t kMostPerRequest = 4096;
/// A longer message is an instrument that does not stop.
constexpr std::size_t kLongestMessage = std::size_t{1} << 20;
constexpr Clock::Duration kControlTimeout = 500ms;
/// Of aborting and of clearing, each in all.
constexpr Clock::Duration kRecovery = 1s;
constexpr Clock::Duration kDrainTimeout = 50ms;
constexpr Clock::Duration kLookAgain = 5ms;
/// For a message after which the process ends.
constexpr Clock::Duration kLastTimeout = 100ms;
/// In an answer about a bulk-in endpoint: its buffer holds bytes that must be read.
constexpr std::uint8_t kHoldsBytes = 0x01;

}  // namespace

Status Usbtmc::write(std::string_view message, Clock::Duration timeout) {
  tag_ = next_tag(tag_);
  Status sent = usb_.bulk_out(encode_message(tag_, std::string(message) + '\n'), timeout);
  if (!sent && sent.error().code != ErrorCode::kUnplugged) {
    // What was taken of it must not stand in front of the next message.
    if (Status aborted = abort(false, tag_); !aborted) std::ignore = clear();
  }
  return sent;
}

void Usbtmc::write_last(std::string_view message) {
  constexpr std::uint8_t kLastTag = 255;  // tag_ is another thread's
  std::ignore = usb_.bulk_out(encode_message(kLastTag, std::string(message) + '\n'), kLastTimeout);
}

Result<std::string> Usbtmc::read(Clock::Duration timeout) {
  const Deadline deadline(timeout);
  std::string message;
  for (;;) {
    auto part = read_part(deadline);
    if (!part) return part.error();
    message += part->text;
    if (part->is_last) break;
    if (message.size() > kLongestMessage) {
      std::ignore = clear();
      return Error{ErrorCode::kProtocol,
                   fmt::format("its answer does not end after {} bytes", message.size())};
    }
  }
  while (message.ends_with('\n') || message.ends_with('\r')) message.pop_back();
  return message;
}

Result<Usbtmc::Part> Usbtmc::read_part(const Deadline& deadline) {
  tag_ = next_tag(tag_);
  const std::uint8_t tag = tag_;
  if (const Status asked = usb_.bulk_out(encode_request(tag, kMostPerRequest), deadline.left());
      !asked) {
    if (asked.error().code != ErrorCode::kUnplugged) std::ignore = clear();
    return asked.error();
  }
  auto part = receive(tag, deadline);
  if (part || part.error().code == ErrorCode::kUnplugged) return part;
  give_up_reading(tag);
  if (part.error().code != ErrorCode::kTimeout) return part;
  const auto status = status_byte();
  return Error{ErrorCode::kTimeout,
               status ? fmt::format("no answer; its status byte is {:#04x}", *status)
                      : part.error().message};
}

Result<Usbtmc::Part> Usbtmc::receive(std::uint8_t tag, const Deadline& deadline) {
  const std::size_t packet = std::max<std::size_t>(usb_.packet_bytes(), 1);
  const std::size_t room = (kHeaderBytes + kMostPerRequest + packet - 1) / packet * packet;
  std::vector<std::uint8_t> bytes(room);
  while (!deadline.passed()) {
    auto count = usb_.bulk_in(bytes, deadline.left());
    if (!count) return count.error();
    if (*count == 0) continue;  // the empty packet behind a transfer of whole packets
    const auto header = decode_answer_header(std::span(bytes).first(*count), kMostPerRequest);
    if (!header) return header.error();
    const std::size_t whole = kHeaderBytes + header->size;
    while (*count < whole && !deadline.passed()) {
      const auto more = usb_.bulk_in(std::span(bytes).subspan(*count), deadline.left());
      if (!more) return more.error();
      *count += *more;
    }
    if (*count < whole) break;
    if (header->tag != tag) continue;  // late: the answer to an earlier request
    return Part{std::string(bytes.begin() + kHeaderBytes,
                            bytes.begin() + static_cast<std::ptrdiff_t>(whole)),
                header->is_last};
  }
  return Error{ErrorCode::kTimeout, "no answer"};
}

void Usbtmc::give_up_reading(std::uint8_t tag) {
  const Status aborted = abort(true, tag);
  if (!aborted && aborted.error().code != ErrorCode::kUnplugged) std::ignore = clear();
}

Status Usbtmc::abort(bool reading, std::uint8_t tag) {
  const Deadline deadline(kRecovery);
  const Recipient endpoint = reading ? Recipient::kBulkIn : Recipient::kBulkOut;
  std::array<std::uint8_t, 2> begun{};
  const auto status =
      control(reading ? kInitiateAbortBulkIn : kInitiateAbortBulkOut, tag, endpoint, begun);
  if (!status) return status.error();
  if (*status == kFailed) return {};  // nothing under way, and nothing left in the buffer
  if (*status != kSuccess) {
    return Error{ErrorCode::kProtocol, fmt::format("refuses to abort: status {:#04x}", *status)};
  }
  if (reading) {
    if (Status drained = drain(deadline); !drained) return drained;
  }
  while (!deadline.passed()) {
    std::array<std::uint8_t, 8> answer{};
    const auto done =
        control(reading ? kCheckAbortBulkInStatus : kCheckAbortBulkOutStatus, 0, endpoint, answer);
    if (!done) return done.error();
    if (*done != kPending) return reading ? Status{} : usb_.clear_halt(Recipient::kBulkOut);
    if (reading && (answer[1] & kHoldsBytes) != 0) {
      if (Status drained = drain(deadline); !drained) return drained;
    } else {
      SteadyClock().sleep_for(kLookAgain);
    }
  }
  return Error{ErrorCode::kTimeout, "does not end its abort"};
}

Status Usbtmc::drain(const Deadline& deadline) {
  const std::size_t packet = std::max<std::size_t>(usb_.packet_bytes(), 1);
  std::vector<std::uint8_t> dropped(packet);
  while (!deadline.passed()) {
    const auto count = usb_.bulk_in(dropped, std::min(kDrainTimeout, deadline.left()));
    if (!count) {
      if (count.error().code == ErrorCode::kTimeout) return {};
      return count.error();
    }
    if (*count < packet) return {};
  }
  return Error{ErrorCode::kProtocol, "does not stop answering"};
}

Status Usbtmc::clear() {
  const Deadline deadline(kRecovery);
  std::array<std::uint8_t, 1> begun{};
  const auto status = control(kInitiateClear, 0, Recipient::kInterface, begun);
  if (!status) return status.error();
  if (*status != kSuccess) {
    return Error{ErrorCode::kProtocol, fmt::format("refuses to clear: status {:#04x}", *status)};
  }
  while (!deadline.passed()) {
    std::array<std::uint8_t, 2> answer{};
    const auto done = control(kCheckClearStatus, 0, Recipient::kInterface, answer);
    if (!done) return done.error();
    // Both sides begin anew, with the endpoint that the instrument has halted meanwhile.
    if (*done == kSuccess) return usb_.clear_halt(Recipient::kBulkOut);
    if (*done != kPending) {
      return Error{ErrorCode::kProtocol, fmt::format("cannot clear: status {:#04x}", *done)};
    }
    if ((answer[1] & kHoldsBytes) != 0) {
      if (Status drained = drain(deadline); !drained) return drained;
    } else {
      SteadyClock().sleep_for(kLookAgain);
    }
  }
  return Error{ErrorCode::kTimeout, "does not end its clear"};
}

Result<std::uint8_t> Usbtmc::status_byte() {
  status_tag_ = next_status_tag(status_tag_);
  std::array<std::uint8_t, 3> answer{};
  const auto status = control(kReadStatusByte, status_tag_, Recipient::kInterface, answer);
  if (!status) return status.error();
  if (*status != kSuccess || answer[1] != status_tag_) {
    return Error{ErrorCode::kProtocol,
                 fmt::format("answers status {:#04x} with tag {} to the request for its status "
                             "byte with tag {}",
                             *status, answer[1], status_tag_)};
  }
  if (!usb_.has_interrupt_in()) return answer[2];
  const Deadline deadline(kControlTimeout);
  while (!deadline.passed()) {
    std::array<std::uint8_t, 2> notice{};
    const auto count = usb_.interrupt_in(notice, deadline.left());
    if (!count) return count.error();
    // Other notices (service requests) may come first.
    if (*count == notice.size() && notice[0] == (0x80 | status_tag_)) return notice[1];
  }
  return Error{ErrorCode::kTimeout, "no status byte"};
}

Result<std::uint8_t> Usbtmc::control(Request request, std::uint16_t value, Recipient recipient,
                                     std::span<std::uint8_t> out) {
  const auto count = usb_.control_in(request, value, recipient, out, kControlTimeout);
  if (!count) return count.error();
  // A refusal may be shorter than what was asked for.
  if (*count == 0 || (*count < out.size() && out[0] == kSuccess)) {
    return Error{ErrorCode::kProtocol, fmt::format("answers request {} with {} bytes, expected {}",
                                                   +request, *count, out.size())};
  }
  return out[0];
}

}  // namespace fogbench::drivers
