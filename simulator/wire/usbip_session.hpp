#pragma once
// One imported device: takes the host's commands, keeps the transfers that the device has not ended
// yet, and says what goes back. No sockets.

#include <deque>

#include "simulator/wire/usb_device.hpp"
#include "simulator/wire/usbip_protocol.hpp"

namespace fogbench::simulator {

class UsbipSession {
 public:
  /// `device` must outlive the session; it starts as after being plugged in.
  explicit UsbipSession(UsbDevice& device) : device_(device) { device_.reset(); }

  /// kProtocol when more transfers are under way than a host has.
  Status take(const UsbipCommand& command, ByteView data);
  /// Goes on with the transfers under way, in their order at each endpoint, and appends what goes
  /// to the host. kDevice when the device has been unplugged.
  Status advance(Bytes& out);

  /// When to advance although the host says nothing.
  drivers::Clock::Instant next() const { return next_; }

 private:
  struct Pending {
    UsbipCommand command;
    Bytes data;
    bool silent = false;
  };

  UsbTransfer go_on(const Pending& pending);
  Bytes unlink(const UsbipCommand& command);

  UsbDevice& device_;
  std::deque<Pending> pending_;
  drivers::Clock::Instant next_ = drivers::Clock::Instant::max();
  Bytes unlinked_;  ///< answers to unlinks, not yet fetched
};

}  // namespace fogbench::simulator
