#pragma once
// A USB device at its transfers: the standard requests and descriptors that every device has (USB
// 2.0, chapter 9), and what a class of devices adds to them. High speed, one configuration, one
// interface.

#include <array>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "drivers/clock.hpp"
#include "simulator/wire/bytes.hpp"
#include "simulator/wire/usbip_protocol.hpp"

namespace fogbench::simulator {

struct UsbEndpoint {
  std::uint8_t address = 0;     ///< bit 7 set: to the host
  std::uint8_t attributes = 0;  ///< 2 bulk, 3 interrupt
  std::uint16_t max_packet = 0;
  std::uint8_t interval = 0;
};

struct UsbIdentity {
  std::uint16_t vendor_id = 0;
  std::uint16_t product_id = 0;
  std::string manufacturer, product, serial;
};

struct UsbDescription {
  UsbIdentity identity;
  std::array<std::uint8_t, 3> interface_class{};
  Bytes class_descriptor;  ///< stands between the interface's and the endpoints'; may be empty
  std::vector<UsbEndpoint> endpoints;
};

inline constexpr std::uint16_t kUsbDeviceRelease = 0x0100;

Bytes usb_device_descriptor(const UsbDescription& description);
Bytes usb_device_qualifier();
Bytes usb_configuration_descriptor(const UsbDescription& description);
/// String 0 names the language, 1 to 3 are manufacturer, product and serial number; empty for any
/// other. What is not ASCII becomes a question mark.
Bytes usb_string_descriptor(const UsbDescription& description, std::uint8_t index);

/// What became of a transfer.
struct UsbTransfer {
  enum class State {
    kDone,
    kStall,   ///< the endpoint is halted, or the request is not supported
    kBusy,    ///< the device takes or has nothing now
    kSilent,  ///< it will never end: the host has to take it back
    kGone,    ///< the device has been unplugged
  };
  State state = State::kDone;
  Bytes data;  ///< to the host
  /// When to ask a busy device again, if it is not the host that has to do something first.
  drivers::Clock::Instant until = drivers::Clock::Instant::max();

  static UsbTransfer done(Bytes data = {}) { return {State::kDone, std::move(data)}; }
  static UsbTransfer in_state(State state) { return {state, {}}; }
  static UsbTransfer busy_until(drivers::Clock::Instant instant) {
    return {State::kBusy, {}, instant};
  }
};

class UsbDevice {
 public:
  explicit UsbDevice(UsbDescription description) : description_(std::move(description)) {}
  UsbDevice(const UsbDevice&) = delete;
  UsbDevice& operator=(const UsbDevice&) = delete;
  virtual ~UsbDevice() = default;

  const UsbDescription& description() const { return description_; }

  /// A transfer on endpoint 0. `data` is that of an OUT request; an answer is at most
  /// setup.length long.
  UsbTransfer control(const UsbSetup& setup, ByteView data);
  /// A whole transfer to `endpoint`, which is not 0; one from it, of at most `most` bytes.
  UsbTransfer out(std::uint8_t endpoint, ByteView data);
  UsbTransfer in(std::uint8_t endpoint, std::size_t most);

  /// As after being plugged in: nothing configured, nothing under way.
  void reset();
  virtual bool plugged() const = 0;

 protected:
  void halt(std::uint8_t address) { halted_.insert(address); }

 private:
  virtual UsbTransfer class_request(const UsbSetup& setup, ByteView data) = 0;
  /// A descriptor that only this class has; kStall when there is none.
  virtual UsbTransfer class_descriptor(std::uint16_t value) = 0;
  virtual UsbTransfer take(ByteView data) = 0;
  virtual UsbTransfer give(std::size_t most) = 0;
  virtual void forget() = 0;

  UsbTransfer standard_request(const UsbSetup& setup);
  UsbTransfer get_descriptor(std::uint16_t value);
  UsbTransfer endpoint_feature(const UsbSetup& setup);
  bool has_endpoint(std::uint8_t address) const;

  const UsbDescription description_;
  std::set<std::uint8_t> halted_;  ///< addresses of endpoints
  std::uint8_t configuration_ = 0;
};

}  // namespace fogbench::simulator
