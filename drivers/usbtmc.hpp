#pragma once
// USBTMC as a conversation: messages, answers in several transfers, aborting and draining after a
// time-out, clear, status byte. The USB itself is behind UsbBulk, so that all of it can be tested.
//
//   write     DEV_DEP_MSG_OUT ──────────────► instrument
//   read      REQUEST_DEV_DEP_MSG_IN ───────►
//             ◄──────────── DEV_DEP_MSG_IN     again until the end of the message is marked
//   time-out  INITIATE_ABORT_BULK_IN ───────►  drain, CHECK_ABORT_BULK_IN_STATUS until done;
//             where that fails, clear
//   clear     INITIATE_CLEAR ───────────────►  drain, CHECK_CLEAR_STATUS until done

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "config/result.hpp"
#include "drivers/clock.hpp"
#include "drivers/deadline.hpp"
#include "drivers/usbtmc_messages.hpp"

namespace fogbench::drivers {

/// One claimed USBTMC interface.
/// Errors of every call: kTimeout, kProtocol (the endpoint or the request is stalled), kUnplugged.
class UsbBulk {
 public:
  enum class Recipient { kInterface, kBulkOut, kBulkIn };

  virtual ~UsbBulk() = default;
  /// All bytes in one transfer.
  virtual Status bulk_out(std::span<const std::uint8_t> bytes, Clock::Duration timeout) = 0;
  /// One transfer, which ends with a short packet or with `out` full. What came before a time-out
  /// is an answer too: kTimeout only when nothing came.
  virtual Result<std::size_t> bulk_in(std::span<std::uint8_t> out, Clock::Duration timeout) = 0;
  /// A class request to the interface or an endpoint; the number of bytes answered.
  virtual Result<std::size_t> control_in(std::uint8_t request, std::uint16_t value,
                                         Recipient recipient, std::span<std::uint8_t> out,
                                         Clock::Duration timeout) = 0;
  virtual Status clear_halt(Recipient endpoint) = 0;
  /// Of an interrupt endpoint, which then carries the status byte; false when there is none.
  virtual bool has_interrupt_in() const = 0;
  virtual Result<std::size_t> interrupt_in(std::span<std::uint8_t> out,
                                           Clock::Duration timeout) = 0;
  /// Largest packet of the bulk-in endpoint.
  virtual std::size_t packet_bytes() const = 0;
};

class Usbtmc {
 public:
  /// `usb` must outlive it.
  explicit Usbtmc(UsbBulk& usb) : usb_(usb) {}

  /// One message; a line feed is added. A time-out has been aborted.
  Status write(std::string_view message, Clock::Duration timeout);
  /// One whole answer without its line end. A time-out has been aborted and drained: the error says
  /// what the instrument's status byte is then.
  Result<std::string> read(Clock::Duration timeout);
  /// Forgets whatever is under way on both sides.
  Status clear();
  /// From any thread, whatever the others are at: one message, and nothing after it.
  void write_last(std::string_view message);
  /// USB488's serial poll.
  Result<std::uint8_t> status_byte();

 private:
  struct Part {
    std::string text;
    bool is_last = false;
  };
  /// One request and its answer.
  Result<Part> read_part(const Deadline& deadline);
  /// The transfer that carries the tag's answer; older ones are thrown away.
  Result<Part> receive(std::uint8_t tag, const Deadline& deadline);
  void give_up_reading(std::uint8_t tag);
  Status abort(bool reading, std::uint8_t tag);
  /// Reads and throws away until a short packet, or nothing more comes.
  Status drain(const Deadline& deadline);
  /// The answer's status, with `out` as the request's answer.
  Result<std::uint8_t> control(usbtmc::Request request, std::uint16_t value,
                               UsbBulk::Recipient recipient, std::span<std::uint8_t> out);

  UsbBulk& usb_;
  std::uint8_t tag_ = 0;
  std::uint8_t status_tag_ = 1;
};

}  // namespace fogbench::drivers
