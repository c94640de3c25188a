#pragma once
// The magnetometer as a USB HID device over its far end: a report descriptor made from the
// instrument's description, input reports on an interrupt endpoint, and the class requests of HID
// 1.11, 7.2.

#include "config/device.hpp"
#include "simulator/hid_far_end.hpp"
#include "simulator/wire/deferring_clock.hpp"
#include "simulator/wire/usb_device.hpp"

namespace fogbench::simulator {

/// One input report of vendor-defined usages: each field of the description is an array of its
/// bytes with a usage of its own, in their order in the report; what no field covers is padding.
Bytes hid_report_descriptor(const config::HidDevice& device);

class HidUsbDevice final : public UsbDevice {
 public:
  static constexpr std::uint8_t kInterruptIn = 0x81;

  /// `far_end` and the clock that it sleeps on must outlive the device.
  HidUsbDevice(const UsbIdentity& identity, const config::HidDevice& device, HidFarEnd& far_end,
               DeferringClock& clock);

  bool plugged() const override { return far_end_.plugged(); }

 private:
  UsbTransfer class_request(const UsbSetup& setup, ByteView data) override;
  UsbTransfer class_descriptor(std::uint16_t value) override;
  UsbTransfer take(ByteView data) override;
  UsbTransfer give(std::size_t most) override;
  void forget() override;

  const Bytes report_descriptor_;
  const Bytes hid_descriptor_;
  const drivers::Clock::Duration period_;
  HidFarEnd& far_end_;
  DeferringClock& clock_;
  drivers::Clock::Instant next_{};  ///< no report before
  Bytes report_;                    ///< the last one
  std::uint8_t idle_ = 0;
};

}  // namespace fogbench::simulator
