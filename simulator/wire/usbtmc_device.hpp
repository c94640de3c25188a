#pragma once
// A coil supply as a USBTMC device with the USB488 subclass, over its far end: messages out on
// bulk-out, one answer for each request on bulk-in, and the class requests to abort, clear and read
// the status byte.
//
// A request that the far end leaves without an answer stays under way until the host aborts it or
// clears the device. An answer that nobody fetched stays in the bulk-in FIFO under its own tag: a
// host that neither aborts nor looks at the tag takes it for the next one.

#include <deque>
#include <string>

#include "simulator/scpi_far_end.hpp"
#include "simulator/wire/deferring_clock.hpp"
#include "simulator/wire/usb_device.hpp"
#include "simulator/wire/usbtmc_protocol.hpp"

namespace fogbench::simulator {

class UsbtmcDevice final : public UsbDevice {
 public:
  static constexpr std::uint8_t kBulkOut = 0x01;
  static constexpr std::uint8_t kBulkIn = 0x82;

  /// `far_end` and the clock that it sleeps on must outlive the device.
  UsbtmcDevice(const UsbIdentity& identity, ScpiFarEnd& far_end, DeferringClock& clock);

  bool plugged() const override { return far_end_.plugged(); }

 private:
  /// One transfer to the host that has been asked for.
  struct Answer {
    std::uint8_t tag = 0;
    drivers::Clock::Instant due{};
    bool silent = false;  ///< it never comes
    Bytes bytes;
    std::size_t sent = 0;
  };

  UsbTransfer class_request(const UsbSetup& setup, ByteView data) override;
  UsbTransfer class_descriptor(std::uint16_t value) override;
  UsbTransfer take(ByteView data) override;
  UsbTransfer give(std::size_t most) override;
  void forget() override;

  UsbTransfer take_message();
  UsbTransfer request_answer(const UsbtmcHeader& header);
  UsbTransfer protocol_error();
  UsbTransfer initiate_clear();
  UsbTransfer read_status_byte(std::uint8_t tag);
  Bytes abort_out(std::uint8_t tag);
  Bytes abort_in(std::uint8_t tag);

  ScpiFarEnd& far_end_;
  DeferringClock& clock_;
  drivers::Clock::Instant ready_at_{};  ///< the instrument is busy until then
  Bytes transfer_;                      ///< bulk-out, as far as it has come
  std::string message_;                 ///< out, until its end
  std::string rest_;                    ///< of an answer that was longer than was asked for
  std::deque<Answer> answers_;          ///< the bulk-in FIFO
  std::uint32_t aborted_bytes_ = 0;     ///< of the transfer that was aborted last
};

}  // namespace fogbench::simulator
