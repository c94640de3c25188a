#include "simulator/wire/usb_device.hpp"

#include <algorithm>

namespace fogbench::simulator {

using State = UsbTransfer::State;

namespace {

// USB 2.0, tables 9-4 and 9-5.
constexpr std::uint8_t kGetStatus = 0;
constexpr std::uint8_t kClearFeature = 1;
constexpr std::uint8_t kSetFeature = 3;
constexpr std::uint8_t kGetDescriptor = 6;
constexpr std::uint8_t kGetConfiguration = 8;
constexpr std::uint8_t kSetConfiguration = 9;
constexpr std::uint8_t kGetInterface = 10;
constexpr std::uint8_t kSetInterface = 11;

constexpr std::uint8_t kDeviceType = 1;
constexpr std::uint8_t kConfigurationType = 2;
constexpr std::uint8_t kStringType = 3;
constexpr std::uint8_t kInterfaceType = 4;
constexpr std::uint8_t kEndpointType = 5;
constexpr std::uint8_t kQualifierType = 6;

constexpr std::uint16_t kUsb20 = 0x0200;
constexpr std::uint8_t kControlPacket = 64;
constexpr std::uint16_t kEnglish = 0x0409;
constexpr std::uint8_t kSelfPowered = 0xC0;  // bmAttributes; bit 7 is always set
constexpr std::uint8_t kHundredMilliampere = 50;

constexpr std::uint8_t kTypeMask = 0x60;  // of bmRequestType: standard, class or vendor
constexpr std::uint8_t kRecipientMask = 0x1F;
constexpr std::uint8_t kToDevice = 0;
constexpr std::uint8_t kToInterface = 1;
constexpr std::uint8_t kToEndpoint = 2;

constexpr std::uint8_t kIn = 0x80;

}  // namespace

Bytes usb_device_descriptor(const UsbDescription& description) {
  Bytes out{18, kDeviceType};
  append_le16(out, kUsb20);
  append(out, Bytes{0, 0, 0, kControlPacket});  // The class stands in the interface.
  append_le16(out, description.identity.vendor_id);
  append_le16(out, description.identity.product_id);
  append_le16(out, kUsbDeviceRelease);
  append(out, Bytes{1, 2, 3, 1});  // strings, one configuration
  return out;
}

Bytes usb_device_qualifier() {
  Bytes out{10, kQualifierType};
  append_le16(out, kUsb20);
  append(out, Bytes{0, 0, 0, kControlPacket, 1, 0});
  return out;
}

Bytes usb_configuration_descriptor(const UsbDescription& description) {
  Bytes inside{9, kInterfaceType, 0, 0, static_cast<std::uint8_t>(description.endpoints.size())};
  append(inside, description.interface_class);
  inside.push_back(0);
  append(inside, description.class_descriptor);
  for (const UsbEndpoint& endpoint : description.endpoints) {
    append(inside, Bytes{7, kEndpointType, endpoint.address, endpoint.attributes});
    append_le16(inside, endpoint.max_packet);
    inside.push_back(endpoint.interval);
  }
  Bytes out{9, kConfigurationType};
  append_le16(out, static_cast<std::uint16_t>(9 + inside.size()));
  append(out, Bytes{1, 1, 0, kSelfPowered, kHundredMilliampere});
  append(out, inside);
  return out;
}

Bytes usb_string_descriptor(const UsbDescription& description, std::uint8_t index) {
  Bytes out{0, kStringType};
  if (index == 0) {
    append_le16(out, kEnglish);
  } else if (index <= 3) {
    const UsbIdentity& is = description.identity;
    const std::string* const texts[] = {&is.manufacturer, &is.product, &is.serial};
    constexpr std::size_t kMostCharacters = 126;  // The length is one byte.
    for (const char c : texts[index - 1]->substr(0, kMostCharacters)) {
      append_le16(out, c >= ' ' && c <= '~' ? static_cast<std::uint8_t>(c) : '?');
    }
  } else {
    return {};
  }
  out[0] = static_cast<std::uint8_t>(out.size());
  return out;
}

UsbTransfer UsbDevice::control(const UsbSetup& setup, ByteView data) {
  UsbTransfer transfer =
      (setup.request_type & kTypeMask) == 0 ? standard_request(setup) : class_request(setup, data);
  if (transfer.data.size() > setup.length) transfer.data.resize(setup.length);
  return transfer;
}

UsbTransfer UsbDevice::out(std::uint8_t endpoint, ByteView data) {
  if (!has_endpoint(endpoint) || halted_.contains(endpoint)) {
    return UsbTransfer::in_state(State::kStall);
  }
  return take(data);
}

UsbTransfer UsbDevice::in(std::uint8_t endpoint, std::size_t most) {
  const std::uint8_t address = endpoint | kIn;
  if (!has_endpoint(address) || halted_.contains(address)) {
    return UsbTransfer::in_state(State::kStall);
  }
  return give(most);
}

void UsbDevice::reset() {
  halted_.clear();
  configuration_ = 0;
  forget();
}

bool UsbDevice::has_endpoint(std::uint8_t address) const {
  return std::any_of(description_.endpoints.begin(), description_.endpoints.end(),
                     [&](const UsbEndpoint& endpoint) { return endpoint.address == address; });
}

UsbTransfer UsbDevice::standard_request(const UsbSetup& setup) {
  const std::uint8_t recipient = setup.request_type & kRecipientMask;
  if (recipient == kToEndpoint) return endpoint_feature(setup);
  const bool to_device = recipient == kToDevice;
  const bool to_interface = recipient == kToInterface && (setup.index & 0xFFU) == 0;
  if (!to_device && !to_interface) return UsbTransfer::in_state(State::kStall);
  switch (setup.request) {
    case kGetDescriptor:
      return to_device ? get_descriptor(setup.value) : class_descriptor(setup.value);
    case kGetStatus:
      return UsbTransfer::done({static_cast<std::uint8_t>(to_device ? 1 : 0), 0});  // Own power.
    case kGetConfiguration:
      if (to_device) return UsbTransfer::done({configuration_});
      break;
    case kSetConfiguration:
      if (!to_device || setup.value > 1) break;
      reset();
      configuration_ = static_cast<std::uint8_t>(setup.value);
      return UsbTransfer::done();
    case kGetInterface:
      if (to_interface) return UsbTransfer::done({0});
      break;
    case kSetInterface:
      if (to_interface && setup.value == 0) return UsbTransfer::done();
      break;
    case kClearFeature:  // Remote wake-up: it never wakes anybody.
    case kSetFeature:
      if (to_device && setup.value == 1) return UsbTransfer::done();
      break;
    default:
      break;
  }
  return UsbTransfer::in_state(State::kStall);
}

UsbTransfer UsbDevice::endpoint_feature(const UsbSetup& setup) {
  const auto address = static_cast<std::uint8_t>(setup.index);
  constexpr std::uint16_t kHalt = 0;
  const bool control = (address & 0x0FU) == 0;
  if (!control && !has_endpoint(address)) return UsbTransfer::in_state(State::kStall);
  if (setup.request == kGetStatus) {
    return UsbTransfer::done({static_cast<std::uint8_t>(halted_.contains(address) ? 1 : 0), 0});
  }
  if (setup.value == kHalt && setup.request == kClearFeature) {
    halted_.erase(address);
    return UsbTransfer::done();
  }
  if (setup.value == kHalt && setup.request == kSetFeature && !control) {
    halt(address);
    return UsbTransfer::done();
  }
  return UsbTransfer::in_state(State::kStall);
}

UsbTransfer UsbDevice::get_descriptor(std::uint16_t value) {
  const auto index = static_cast<std::uint8_t>(value);
  switch (value >> 8U) {
    case kDeviceType:
      return UsbTransfer::done(usb_device_descriptor(description_));
    case kConfigurationType:
      if (index == 0) return UsbTransfer::done(usb_configuration_descriptor(description_));
      break;
    case kStringType:
      if (Bytes text = usb_string_descriptor(description_, index); !text.empty()) {
        return UsbTransfer::done(std::move(text));
      }
      break;
    case kQualifierType:
      return UsbTransfer::done(usb_device_qualifier());
    default:
      break;
  }
  return UsbTransfer::in_state(State::kStall);
}

}  // namespace fogbench::simulator
