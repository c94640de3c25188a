#include "simulator/wire/usbip_protocol.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace fogbench::simulator {
namespace {

constexpr std::uint16_t kVersion = 0x0111;
constexpr std::uint16_t kRequestList = 0x8005;
constexpr std::uint16_t kRequestImport = 0x8003;
constexpr std::uint16_t kReplyList = 0x0005;
constexpr std::uint16_t kReplyImport = 0x0003;
constexpr std::size_t kOperationBytes = 8;
constexpr std::size_t kPathBytes = 256;
constexpr std::size_t kBusIdBytes = 32;

constexpr std::uint32_t kSubmit = 1;
constexpr std::uint32_t kUnlink = 2;
constexpr std::uint32_t kSubmitted = 3;
constexpr std::uint32_t kUnlinked = 4;
constexpr std::uint32_t kMostEndpoint = 15;
/// What stands for the number of packets of a transfer that is not isochronous; some hosts send 0.
constexpr std::uint32_t kNotIsochronous = 0xFFFFFFFF;

constexpr std::uint32_t kHighSpeed = 3;  // enum usb_device_speed

void append_text(Bytes& out, std::string_view text, std::size_t field) {
  const std::size_t count = std::min(text.size(), field - 1);
  out.insert(out.end(), text.begin(), text.begin() + static_cast<std::ptrdiff_t>(count));
  out.resize(out.size() + field - count);
}

void append_operation(Bytes& out, std::uint16_t code, std::uint32_t status) {
  append_be16(out, kVersion);
  append_be16(out, code);
  append_be32(out, status);
}

void append_device(Bytes& out, const UsbipDevice& device) {
  append_text(out, "/sys/devices/platform/fogbench/usb1/" + device.bus_id, kPathBytes);
  append_text(out, device.bus_id, kBusIdBytes);
  append_be32(out, device.bus_number);
  append_be32(out, device.device_number);
  append_be32(out, kHighSpeed);
  append_be16(out, device.vendor_id);
  append_be16(out, device.product_id);
  append_be16(out, device.device_release);
  // The class is the interface's; one configuration with one interface, and it is active.
  append(out, Bytes{0, 0, 0, 1, 1, 1});
}

/// The header of an answer: which command, and nothing of device, direction and endpoint.
Bytes answer_header(std::uint32_t code, std::uint32_t sequence, std::int32_t status) {
  Bytes out;
  append_be32(out, code);
  append_be32(out, sequence);
  out.resize(20);
  append_be32(out, static_cast<std::uint32_t>(status));
  return out;
}

}  // namespace

Result<std::optional<UsbipRequest>> parse_usbip_request(ByteView bytes) {
  if (bytes.size() < kOperationBytes) return std::optional<UsbipRequest>();
  const std::uint16_t version = be16_at(bytes, 0);
  if (version != kVersion) {
    return Error{ErrorCode::kProtocol,
                 fmt::format("USB/IP version 0x{:04x}, expected 0x{:04x}", version, kVersion)};
  }
  UsbipRequest request;
  switch (const std::uint16_t code = be16_at(bytes, 2)) {
    case kRequestList:
      request.size = kOperationBytes;
      return std::optional(request);
    case kRequestImport: {
      request.operation = UsbipOperation::kImport;
      request.size = kOperationBytes + kBusIdBytes;
      if (bytes.size() < request.size) return std::optional<UsbipRequest>();
      const ByteView name = bytes.subspan(kOperationBytes, kBusIdBytes);
      request.bus_id.assign(name.begin(), std::find(name.begin(), name.end(), 0));
      return std::optional(request);
    }
    default:
      return Error{ErrorCode::kProtocol,
                   fmt::format("USB/IP operation 0x{:04x}, expected a list (0x{:04x}) or an import "
                               "(0x{:04x})",
                               code, kRequestList, kRequestImport)};
  }
}

Bytes encode_device_list(std::span<const UsbipDevice> devices) {
  Bytes out;
  append_operation(out, kReplyList, 0);
  append_be32(out, static_cast<std::uint32_t>(devices.size()));
  for (const UsbipDevice& device : devices) {
    append_device(out, device);
    append(out, device.interface_class);
    out.push_back(0);
  }
  return out;
}

Bytes encode_import(UsbipImportStatus status, const UsbipDevice& device) {
  Bytes out;
  append_operation(out, kReplyImport, static_cast<std::uint32_t>(status));
  if (status == UsbipImportStatus::kOk) append_device(out, device);
  return out;
}

UsbSetup parse_setup(std::span<const std::uint8_t, 8> bytes) {
  return {.request_type = bytes[0],
          .request = bytes[1],
          .value = le16_at(bytes, 2),
          .index = le16_at(bytes, 4),
          .length = le16_at(bytes, 6)};
}

Result<std::optional<UsbipCommand>> parse_usbip_command(ByteView bytes) {
  if (bytes.size() < kUsbipHeaderBytes) return std::optional<UsbipCommand>();
  const std::uint32_t code = be32_at(bytes, 0);
  if (code != kSubmit && code != kUnlink) {
    return Error{ErrorCode::kProtocol,
                 fmt::format("USB/IP command {}, expected {} or {}", code, kSubmit, kUnlink)};
  }
  UsbipCommand command;
  command.sequence = be32_at(bytes, 4);
  command.size = kUsbipHeaderBytes;
  if (code == kUnlink) {
    command.unlink = true;
    command.unlinked = be32_at(bytes, 20);
    return std::optional(command);
  }
  const std::uint32_t direction = be32_at(bytes, 12);
  const std::uint32_t endpoint = be32_at(bytes, 16);
  const std::uint32_t packets = be32_at(bytes, 32);
  command.length = be32_at(bytes, 24);
  if (direction > 1 || endpoint > kMostEndpoint) {
    return Error{ErrorCode::kProtocol,
                 fmt::format("direction {}, endpoint {}; expected at most 1 and {}", direction,
                             endpoint, kMostEndpoint)};
  }
  if (packets != 0 && packets != kNotIsochronous) {
    return Error{ErrorCode::kProtocol,
                 fmt::format("{} isochronous packets, expected none", packets)};
  }
  if (command.length > kMostTransferBytes) {
    return Error{ErrorCode::kProtocol, fmt::format("a transfer of {} bytes, expected at most {}",
                                                   command.length, kMostTransferBytes)};
  }
  command.in = direction == 1;
  command.endpoint = static_cast<std::uint8_t>(endpoint);
  command.setup = parse_setup(bytes.subspan<40, 8>());
  if (!command.in) command.size += command.length;
  if (bytes.size() < command.size) return std::optional<UsbipCommand>();
  return std::optional(command);
}

Bytes encode_submitted(const UsbipCommand& command, std::int32_t status, std::uint32_t actual,
                       ByteView data) {
  Bytes out = answer_header(kSubmitted, command.sequence, status);
  append_be32(out, actual);
  out.resize(kUsbipHeaderBytes);  // No start frame, packets, errors.
  if (command.in) append(out, data);
  return out;
}

Bytes encode_unlinked(std::uint32_t sequence, std::int32_t status) {
  Bytes out = answer_header(kUnlinked, sequence, status);
  out.resize(kUsbipHeaderBytes);
  return out;
}

}  // namespace fogbench::simulator
