#include "simulator/wire/usbtmc_device.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace fogbench::simulator {

using State = UsbTransfer::State;
using drivers::Clock;

namespace {

using namespace std::chrono_literals;

/// What a far end takes for the host's patience: nobody waits for an answer less long.
constexpr Clock::Duration kPatience = 1s;
constexpr std::size_t kLongestMessage = 4096;
constexpr std::size_t kMostAnswers = 16;
constexpr std::uint16_t kBulkPacket = 512;  // Bulk at high speed, whatever the device likes.

constexpr std::uint8_t kBulk = 2;
/// Application class, USBTMC, USB488.
constexpr std::array<std::uint8_t, 3> kUsbtmcClass = {0xFE, 0x03, 0x01};

UsbDescription describe(const UsbIdentity& identity) {
  return {.identity = identity,
          .interface_class = kUsbtmcClass,
          .class_descriptor = {},
          .endpoints = {{UsbtmcDevice::kBulkOut, kBulk, kBulkPacket, 0},
                        {UsbtmcDevice::kBulkIn, kBulk, kBulkPacket, 0}}};
}

std::uint8_t code_of(UsbtmcStatus status) {
  return static_cast<std::uint8_t>(status);
}

/// What a far end's error means for a transfer.
UsbTransfer failed_transfer(const Error& error) {
  return UsbTransfer::in_state(error.code == ErrorCode::kUnplugged ? State::kGone : State::kSilent);
}

}  // namespace

UsbtmcDevice::UsbtmcDevice(const UsbIdentity& identity, ScpiFarEnd& far_end, DeferringClock& clock)
    : UsbDevice(describe(identity)), far_end_(far_end), clock_(clock) {}

void UsbtmcDevice::forget() {
  transfer_.clear();
  message_.clear();
  rest_.clear();
  answers_.clear();
}

UsbTransfer UsbtmcDevice::protocol_error() {
  transfer_.clear();
  halt(kBulkOut);
  return UsbTransfer::in_state(State::kStall);
}

UsbTransfer UsbtmcDevice::take(ByteView data) {
  if (clock_.now() < ready_at_) return UsbTransfer::busy_until(ready_at_);
  append(transfer_, data);
  const std::optional<UsbtmcHeader> header = parse_usbtmc_header(transfer_);
  if (!header) return protocol_error();
  if (header->message == UsbtmcMessage::kRequestIn) {
    const bool alone = transfer_.size() == kUsbtmcHeaderBytes;
    transfer_.clear();
    return alone ? request_answer(*header) : protocol_error();
  }
  if (message_.size() + header->size > kLongestMessage) return protocol_error();
  const std::size_t end = kUsbtmcHeaderBytes + header->size;
  if (transfer_.size() < end) return UsbTransfer::done();
  constexpr std::size_t kMostPadding = 3;
  if (transfer_.size() > end + kMostPadding) return protocol_error();
  message_.append(transfer_.begin() + kUsbtmcHeaderBytes,
                  transfer_.begin() + static_cast<std::ptrdiff_t>(end));
  transfer_.clear();
  return header->end_of_message ? take_message() : UsbTransfer::done();
}

UsbTransfer UsbtmcDevice::take_message() {
  rest_.clear();
  const Status taken = far_end_.write(std::exchange(message_, {}));
  const Clock::Instant due = clock_.take_due();
  if (!taken) return failed_transfer(taken.error());
  ready_at_ = due;
  return UsbTransfer::done();
}

UsbTransfer UsbtmcDevice::request_answer(const UsbtmcHeader& header) {
  if (answers_.size() >= kMostAnswers || header.size == 0) return protocol_error();
  Answer answer{.tag = header.tag};
  if (rest_.empty()) {
    Result<std::string> text = far_end_.read(kPatience);
    const Clock::Instant due = clock_.take_due();
    if (text) {
      rest_ = *std::move(text) + "\n";
      answer.due = due;
      ready_at_ = due;
    } else if (text.error().code == ErrorCode::kUnplugged) {
      return failed_transfer(text.error());
    } else if (text.error().code == ErrorCode::kProtocol) {
      // The answer to another request: under another tag, which is never 0.
      answer.tag = static_cast<std::uint8_t>(header.tag == 1 ? 255 : header.tag - 1);
      answer.due = due;
      rest_ = "0\n";
    } else {
      answer.silent = true;
    }
  }
  if (!answer.silent) {
    const std::string part = rest_.substr(0, header.size);
    rest_.erase(0, part.size());
    answer.bytes = encode_usbtmc_answer(answer.tag, part, rest_.empty());
  }
  answers_.push_back(std::move(answer));
  return UsbTransfer::done();
}

UsbTransfer UsbtmcDevice::give(std::size_t most) {
  if (answers_.empty()) return UsbTransfer::in_state(State::kBusy);
  Answer& answer = answers_.front();
  if (answer.silent) return UsbTransfer::in_state(State::kBusy);
  if (clock_.now() < answer.due) return UsbTransfer::busy_until(answer.due);
  const std::size_t count = std::min(most, answer.bytes.size() - answer.sent);
  const auto begin = answer.bytes.begin() + static_cast<std::ptrdiff_t>(answer.sent);
  Bytes data(begin, begin + static_cast<std::ptrdiff_t>(count));
  answer.sent += count;
  // A transfer ends with a short packet, an empty one when the last was full to the brim.
  const bool short_packet = count < most || answer.bytes.size() % kBulkPacket != 0;
  if (answer.sent == answer.bytes.size() && short_packet) answers_.pop_front();
  return UsbTransfer::done(std::move(data));
}

UsbTransfer UsbtmcDevice::class_descriptor(std::uint16_t) {
  return UsbTransfer::in_state(State::kStall);
}

UsbTransfer UsbtmcDevice::class_request(const UsbSetup& setup, ByteView) {
  constexpr std::uint8_t kClassIn = 0xA0;  // to the host, of a class; to interface or endpoint
  if ((setup.request_type & 0xE0U) != kClassIn) return UsbTransfer::in_state(State::kStall);
  const auto tag = static_cast<std::uint8_t>(setup.value);
  switch (static_cast<UsbtmcRequest>(setup.request)) {
    case UsbtmcRequest::kGetCapabilities:
      return UsbTransfer::done(usbtmc_capabilities());
    case UsbtmcRequest::kInitiateAbortOut:
      return UsbTransfer::done(abort_out(tag));
    case UsbtmcRequest::kInitiateAbortIn:
      return UsbTransfer::done(abort_in(tag));
    case UsbtmcRequest::kCheckAbortOut:
    case UsbtmcRequest::kCheckAbortIn: {
      Bytes out{code_of(UsbtmcStatus::kSuccess), 0, 0, 0};
      append_le32(out, aborted_bytes_);
      return UsbTransfer::done(std::move(out));
    }
    case UsbtmcRequest::kInitiateClear:
      return initiate_clear();
    case UsbtmcRequest::kCheckClear: {
      const bool busy = clock_.now() < ready_at_;
      return UsbTransfer::done(
          {code_of(busy ? UsbtmcStatus::kPending : UsbtmcStatus::kSuccess), 0});
    }
    case UsbtmcRequest::kReadStatusByte:
      return read_status_byte(tag);
  }
  return UsbTransfer::in_state(State::kStall);
}

UsbTransfer UsbtmcDevice::initiate_clear() {
  const Status cleared = far_end_.clear();
  const Clock::Instant due = clock_.take_due();
  if (!cleared) return failed_transfer(cleared.error());
  forget();
  ready_at_ = due;
  return UsbTransfer::done({code_of(UsbtmcStatus::kSuccess)});
}

UsbTransfer UsbtmcDevice::read_status_byte(std::uint8_t tag) {
  Result<std::uint8_t> status = far_end_.read_status_byte();
  clock_.take_due();
  if (!status) return failed_transfer(status.error());
  constexpr std::uint8_t kMessageAvailable = 0x10;
  const bool available = !rest_.empty() || std::any_of(answers_.begin(), answers_.end(),
                                                       [](const Answer& a) { return !a.silent; });
  const auto all = static_cast<std::uint8_t>(*status | (available ? kMessageAvailable : 0));
  return UsbTransfer::done({code_of(UsbtmcStatus::kSuccess), tag, all});
}

Bytes UsbtmcDevice::abort_out(std::uint8_t tag) {
  const std::optional<UsbtmcHeader> header = parse_usbtmc_header(transfer_);
  if (!header) return {code_of(UsbtmcStatus::kFailed), tag};
  if (header->tag != tag) return {code_of(UsbtmcStatus::kNotInProgress), header->tag};
  aborted_bytes_ = static_cast<std::uint32_t>(transfer_.size());
  transfer_.clear();
  message_.clear();
  return {code_of(UsbtmcStatus::kSuccess), tag};
}

Bytes UsbtmcDevice::abort_in(std::uint8_t tag) {
  if (answers_.empty()) return {code_of(UsbtmcStatus::kFailed), tag};
  const auto found = std::find_if(answers_.begin(), answers_.end(),
                                  [tag](const Answer& answer) { return answer.tag == tag; });
  if (found == answers_.end()) return {code_of(UsbtmcStatus::kNotInProgress), answers_.front().tag};
  aborted_bytes_ = static_cast<std::uint32_t>(found->sent);
  // What is left of it is the empty packet that ends the transfer; the rest of the answer is lost.
  *found = Answer{.tag = 0};
  rest_.clear();
  return {code_of(UsbtmcStatus::kSuccess), tag};
}

}  // namespace fogbench::simulator
