#pragma once
// USB/IP 1.1.1 in bytes, as the kernel's documentation has it
// (Documentation/usb/usbip_protocol.rst): big-endian throughout. First operations, each on a fresh
// connection: list the exported devices, or import one. After an import the same connection carries
// its transfers.
//
// Pure functions over bytes that may be anything.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "config/result.hpp"
#include "simulator/wire/bytes.hpp"

namespace fogbench::simulator {

/// What an import or a list says of one device.
struct UsbipDevice {
  std::string bus_id;  ///< "1-2": the name that `usbip attach --busid` takes
  std::uint32_t bus_number = 1;
  std::uint32_t device_number = 0;
  std::uint16_t vendor_id = 0;
  std::uint16_t product_id = 0;
  std::uint16_t device_release = 0;               ///< bcdDevice
  std::array<std::uint8_t, 3> interface_class{};  ///< class, subclass, protocol of the only one
};

enum class UsbipOperation { kList, kImport };
struct UsbipRequest {
  UsbipOperation operation = UsbipOperation::kList;
  std::string bus_id;    ///< of an import
  std::size_t size = 0;  ///< bytes that the request took
};

/// The first request at the beginning of `bytes`; none while it is incomplete. kProtocol for what
/// is no request.
Result<std::optional<UsbipRequest>> parse_usbip_request(ByteView bytes);

Bytes encode_device_list(std::span<const UsbipDevice> devices);

enum class UsbipImportStatus : std::uint32_t { kOk = 0, kBusy = 2, kNoDevice = 4 };
/// `device` is sent when the status is kOk.
Bytes encode_import(UsbipImportStatus status, const UsbipDevice& device);

/// The eight bytes that open a control transfer (USB 2.0, 9.3).
struct UsbSetup {
  std::uint8_t request_type = 0;
  std::uint8_t request = 0;
  std::uint16_t value = 0;
  std::uint16_t index = 0;
  std::uint16_t length = 0;
};
UsbSetup parse_setup(std::span<const std::uint8_t, 8> bytes);

/// CMD_SUBMIT or CMD_UNLINK.
struct UsbipCommand {
  bool unlink = false;
  std::uint32_t sequence = 0;
  std::uint32_t unlinked = 0;  ///< the sequence number that an unlink takes back
  std::uint8_t endpoint = 0;   ///< number, without the direction
  bool in = false;             ///< to the host
  std::uint32_t length = 0;    ///< of the transfer's buffer
  UsbSetup setup;              ///< of endpoint 0
  std::size_t size = 0;        ///< bytes that the command took, those of an OUT transfer included
};

inline constexpr std::size_t kUsbipHeaderBytes = 48;
/// A longer transfer is refused: the kernel splits what these devices are sent far below it.
inline constexpr std::uint32_t kMostTransferBytes = 256 * 1024;

/// The first command; none while it is incomplete. Its OUT data are the bytes from
/// kUsbipHeaderBytes to `size`. kProtocol for an unknown command, an endpoint above 15, isochronous
/// packets or a length beyond kMostTransferBytes.
Result<std::optional<UsbipCommand>> parse_usbip_command(ByteView bytes);

/// Linux error numbers, as the protocol carries them whatever the server's system.
inline constexpr std::int32_t kUsbStall = -32;      ///< EPIPE
inline constexpr std::int32_t kUsbUnlinked = -104;  ///< ECONNRESET

/// `data` is sent for an IN transfer only; `actual` bytes went over the wire.
Bytes encode_submitted(const UsbipCommand& command, std::int32_t status, std::uint32_t actual,
                       ByteView data);
Bytes encode_unlinked(std::uint32_t sequence, std::int32_t status);

}  // namespace fogbench::simulator
