#include "simulator/wire/hid_device.hpp"

#include <algorithm>
#include <bit>

#include "drivers/number_codec.hpp"

namespace fogbench::simulator {

using State = UsbTransfer::State;

namespace {

constexpr std::uint8_t kHidType = 0x21;
constexpr std::uint8_t kReportType = 0x22;
constexpr std::array<std::uint8_t, 3> kHidClass = {0x03, 0x00, 0x00};  // HID, no boot protocol
constexpr std::uint8_t kInterrupt = 3;

// HID 1.11, 7.2
constexpr std::uint8_t kGetReport = 0x01;
constexpr std::uint8_t kGetIdle = 0x02;
constexpr std::uint8_t kSetReport = 0x09;
constexpr std::uint8_t kSetIdle = 0x0A;

Bytes hid_descriptor(const Bytes& report_descriptor) {
  Bytes out{9, kHidType, 0x11, 0x01, 0, 1, kReportType};
  append_le16(out, static_cast<std::uint16_t>(report_descriptor.size()));
  return out;
}

/// At high speed an interrupt endpoint is asked every 2^(n - 1) * 125 us.
std::uint8_t interval(config::Seconds period) {
  const auto microframes = static_cast<unsigned>(std::clamp(period.count() / 125e-6, 1.0, 32768.0));
  return static_cast<std::uint8_t>(std::bit_width(microframes));
}

UsbDescription describe(const UsbIdentity& identity, const config::HidDevice& device) {
  constexpr std::uint16_t kMostPacket = 1024;
  return {
      .identity = identity,
      .interface_class = kHidClass,
      .class_descriptor = hid_descriptor(hid_report_descriptor(device)),
      .endpoints = {{HidUsbDevice::kInterruptIn, kInterrupt,
                     std::min(device.report_bytes, kMostPacket), interval(device.report_period)}}};
}

/// `count` bytes of a report: a field with that usage, or padding when it is 0.
void append_bytes_item(Bytes& out, std::uint8_t usage, std::size_t count) {
  if (count == 0) return;
  if (usage != 0) append(out, Bytes{0x09, usage});
  out.push_back(0x96);  // REPORT_COUNT, two bytes
  append_le16(out, static_cast<std::uint16_t>(count));
  append(out, usage != 0 ? Bytes{0x81, 0x02}    // INPUT (Data, Variable, Absolute)
                         : Bytes{0x81, 0x03});  // INPUT (Constant)
}

}  // namespace

Bytes hid_report_descriptor(const config::HidDevice& device) {
  Bytes out{0x06, 0x00, 0xFF,  // USAGE_PAGE (vendor-defined)
            0x09, 0x01,        // USAGE (1)
            0xA1, 0x01,        // COLLECTION (Application)
            0x15, 0x00,        // LOGICAL_MINIMUM (0)
            0x26, 0xFF, 0x00,  // LOGICAL_MAXIMUM (255)
            0x75, 0x08};       // REPORT_SIZE (8 bits)
  std::size_t at = 0;
  if (device.report_id != 0) {
    append(out, Bytes{0x85, device.report_id});  // REPORT_ID
    at = 1;
  }
  std::vector<const config::FieldSpec*> fields;
  for (const config::FieldSpec& field : device.fields) fields.push_back(&field);
  std::sort(fields.begin(), fields.end(),
            [](const auto* a, const auto* b) { return a->offset_bytes < b->offset_bytes; });
  std::uint8_t usage = 1;
  for (const config::FieldSpec* field : fields) {
    const std::size_t bytes = drivers::byte_count(field->type);
    if (field->offset_bytes < at || field->offset_bytes + bytes > device.report_bytes) continue;
    append_bytes_item(out, 0, field->offset_bytes - at);
    append_bytes_item(out, ++usage, bytes);
    at = field->offset_bytes + bytes;
  }
  append_bytes_item(out, 0, device.report_bytes - at);
  out.push_back(0xC0);  // END_COLLECTION
  return out;
}

HidUsbDevice::HidUsbDevice(const UsbIdentity& identity, const config::HidDevice& device,
                           HidFarEnd& far_end, DeferringClock& clock)
    : UsbDevice(describe(identity, device)),
      report_descriptor_(hid_report_descriptor(device)),
      hid_descriptor_(hid_descriptor(report_descriptor_)),
      period_(drivers::from_seconds(device.report_period.count())),
      far_end_(far_end),
      clock_(clock),
      report_(device.report_bytes) {}

void HidUsbDevice::forget() {
  next_ = {};
}

UsbTransfer HidUsbDevice::give(std::size_t most) {
  if (clock_.now() < next_) return UsbTransfer::busy_until(next_);
  Bytes report(report_.size());
  const Result<std::size_t> count = far_end_.read_report(report, period_);
  const drivers::Clock::Instant now = clock_.take_due();
  if (count && next_ != drivers::Clock::Instant{}) {
    next_ += ((now - next_) / period_ + 1) * period_;  // The far end is not asked in vain.
  } else {
    next_ = now;  // Without a report, this is when the next is due.
  }
  if (!count) {
    const bool gone = count.error().code == ErrorCode::kUnplugged;
    return gone ? UsbTransfer::in_state(State::kGone) : UsbTransfer::busy_until(next_);
  }
  report_ = report;
  report.resize(std::min(report.size(), most));
  return UsbTransfer::done(std::move(report));
}

UsbTransfer HidUsbDevice::take(ByteView) {
  return UsbTransfer::in_state(State::kStall);  // There is no endpoint out.
}

UsbTransfer HidUsbDevice::class_descriptor(std::uint16_t value) {
  switch (value >> 8U) {
    case kHidType:
      return UsbTransfer::done(hid_descriptor_);
    case kReportType:
      return UsbTransfer::done(report_descriptor_);
    default:
      return UsbTransfer::in_state(State::kStall);
  }
}

UsbTransfer HidUsbDevice::class_request(const UsbSetup& setup, ByteView data) {
  constexpr std::uint8_t kHidIn = 0xA1;  // class, interface
  constexpr std::uint8_t kHidOut = 0x21;
  if (setup.request_type == kHidIn && setup.request == kGetReport) {
    constexpr std::uint8_t kInput = 1;
    if (setup.value >> 8U == kInput) return UsbTransfer::done(report_);
  } else if (setup.request_type == kHidIn && setup.request == kGetIdle) {
    return UsbTransfer::done({idle_});
  } else if (setup.request_type == kHidOut && setup.request == kSetIdle) {
    idle_ = static_cast<std::uint8_t>(setup.value >> 8U);
    return UsbTransfer::done();
  } else if (setup.request_type == kHidOut && setup.request == kSetReport) {
    const Status written = far_end_.write_report(data);
    if (written) return UsbTransfer::done();
    if (written.error().code == ErrorCode::kUnplugged) return UsbTransfer::in_state(State::kGone);
  }
  return UsbTransfer::in_state(State::kStall);
}

}  // namespace fogbench::simulator
