#include "drivers/libusb_device.hpp"

#include <fmt/format.h>
#include <libusb.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <string>

#include "drivers/process_lock.hpp"

namespace fogbench::drivers {
namespace {

/// Class and subclass of the interface (USBTMC 1.0, table 43).
constexpr std::uint8_t kApplicationSpecific = 0xFE;
constexpr std::uint8_t kTestAndMeasurement = 0x03;

struct ContextCloser {
  void operator()(libusb_context* context) const { libusb_exit(context); }
};
struct HandleCloser {
  void operator()(libusb_device_handle* handle) const { libusb_close(handle); }
};
using Context = std::unique_ptr<libusb_context, ContextCloser>;
using Handle = std::unique_ptr<libusb_device_handle, HandleCloser>;

/// libusb takes 0 for ever; a deadline that has passed waits a millisecond.
unsigned wait_ms(Clock::Duration timeout) {
  return static_cast<unsigned>(std::max(Deadline(timeout).left_ms(), 1));
}

Error usb_error(int code, const std::string& what) {
  const std::string message = fmt::format("{}: {}", what, libusb_strerror(code));
  switch (code) {
    case LIBUSB_ERROR_TIMEOUT:
      return {ErrorCode::kTimeout, message};
    case LIBUSB_ERROR_PIPE:
    case LIBUSB_ERROR_OVERFLOW:
      return {ErrorCode::kProtocol, message};
    default:
      return {ErrorCode::kUnplugged, message};
  }
}

/// Where the interface's endpoints are.
struct Interface {
  int number = -1;
  std::uint8_t bulk_in = 0, bulk_out = 0;
  std::uint8_t interrupt_in = 0;  ///< 0 when there is none
  std::size_t packet_bytes = 0;
};

class LibusbDevice final : public UsbBulk {
 public:
  LibusbDevice(Context context, Handle handle, const Interface& interface)
      : context_(std::move(context)), handle_(std::move(handle)), interface_(interface) {}
  ~LibusbDevice() override { libusb_release_interface(handle_.get(), interface_.number); }

  Status bulk_out(std::span<const std::uint8_t> bytes, Clock::Duration timeout) override {
    int done = 0;
    // libusb writes nothing through the pointer of an outgoing transfer.
    const int code = libusb_bulk_transfer(handle_.get(), interface_.bulk_out,
                                          const_cast<std::uint8_t*>(bytes.data()),
                                          static_cast<int>(bytes.size()), &done, wait_ms(timeout));
    if (code == 0 && done == static_cast<int>(bytes.size())) return {};
    return stalled(code == 0 ? LIBUSB_ERROR_TIMEOUT : code, interface_.bulk_out, "sending");
  }

  Result<std::size_t> bulk_in(std::span<std::uint8_t> out, Clock::Duration timeout) override {
    return receive(libusb_bulk_transfer, interface_.bulk_in, out, timeout);
  }

  Result<std::size_t> control_in(std::uint8_t request, std::uint16_t value, Recipient recipient,
                                 std::span<std::uint8_t> out, Clock::Duration timeout) override {
    const bool to_interface = recipient == Recipient::kInterface;
    const auto type = static_cast<std::uint8_t>(
        +LIBUSB_ENDPOINT_IN | +LIBUSB_REQUEST_TYPE_CLASS |
        +(to_interface ? LIBUSB_RECIPIENT_INTERFACE : LIBUSB_RECIPIENT_ENDPOINT));
    const int index = to_interface ? interface_.number : endpoint(recipient);
    const int count = libusb_control_transfer(
        handle_.get(), type, request, value, static_cast<std::uint16_t>(index), out.data(),
        static_cast<std::uint16_t>(out.size()), wait_ms(timeout));
    if (count < 0) return usb_error(count, fmt::format("request {}", request));
    return static_cast<std::size_t>(count);
  }

  Status clear_halt(Recipient recipient) override {
    const int code = libusb_clear_halt(handle_.get(), endpoint(recipient));
    if (code != 0) return usb_error(code, "clearing a halt");
    return {};
  }

  bool has_interrupt_in() const override { return interface_.interrupt_in != 0; }
  Result<std::size_t> interrupt_in(std::span<std::uint8_t> out, Clock::Duration timeout) override {
    return receive(libusb_interrupt_transfer, interface_.interrupt_in, out, timeout);
  }
  std::size_t packet_bytes() const override { return interface_.packet_bytes; }

 private:
  std::uint8_t endpoint(Recipient recipient) const {
    return recipient == Recipient::kBulkIn ? interface_.bulk_in : interface_.bulk_out;
  }

  Result<std::size_t> receive(decltype(&libusb_bulk_transfer) transfer, std::uint8_t from,
                              std::span<std::uint8_t> out, Clock::Duration timeout) {
    int done = 0;
    const int code = transfer(handle_.get(), from, out.data(), static_cast<int>(out.size()), &done,
                              wait_ms(timeout));
    if (code == 0 || (code == LIBUSB_ERROR_TIMEOUT && done > 0)) {
      return static_cast<std::size_t>(done);
    }
    return stalled(code, from, "receiving");
  }

  /// The error; a stalled endpoint is made usable again.
  Error stalled(int code, std::uint8_t at, const char* what) {
    if (code == LIBUSB_ERROR_PIPE) libusb_clear_halt(handle_.get(), at);
    return usb_error(code, what);
  }

  Context context_;  // Before the handle, which is closed first.
  Handle handle_;
  Interface interface_;
};

std::optional<Interface> find_interface(libusb_device* device) {
  libusb_config_descriptor* config = nullptr;
  if (libusb_get_active_config_descriptor(device, &config) != 0) return std::nullopt;
  const std::unique_ptr<libusb_config_descriptor, decltype(&libusb_free_config_descriptor)> owned(
      config, libusb_free_config_descriptor);
  for (const libusb_interface& each : std::span(config->interface, config->bNumInterfaces)) {
    if (each.num_altsetting == 0) continue;
    const libusb_interface_descriptor& setting = each.altsetting[0];
    if (setting.bInterfaceClass != kApplicationSpecific ||
        setting.bInterfaceSubClass != kTestAndMeasurement) {
      continue;
    }
    Interface found;
    found.number = setting.bInterfaceNumber;
    for (const libusb_endpoint_descriptor& e : std::span(setting.endpoint, setting.bNumEndpoints)) {
      const int type = e.bmAttributes & LIBUSB_TRANSFER_TYPE_MASK;
      const bool in = (e.bEndpointAddress & LIBUSB_ENDPOINT_IN) != 0;
      if (type == LIBUSB_TRANSFER_TYPE_BULK && in) {
        found.bulk_in = e.bEndpointAddress;
        found.packet_bytes = e.wMaxPacketSize;
      } else if (type == LIBUSB_TRANSFER_TYPE_BULK) {
        found.bulk_out = e.bEndpointAddress;
      } else if (type == LIBUSB_TRANSFER_TYPE_INTERRUPT && in) {
        found.interrupt_in = e.bEndpointAddress;
      }
    }
    if (found.bulk_in != 0 && found.bulk_out != 0) return found;
  }
  return std::nullopt;
}

std::string serial_of(libusb_device_handle* handle, std::uint8_t index) {
  unsigned char text[128] = {};
  const int length = libusb_get_string_descriptor_ascii(handle, index, text, sizeof text);
  return length <= 0
             ? ""
             : std::string(reinterpret_cast<const char*>(text), static_cast<std::size_t>(length));
}

/// The file by which processes have the device.
std::string node_of(libusb_device_handle* handle) {
  libusb_device* const device = libusb_get_device(handle);
  return fmt::format("/dev/bus/usb/{:03}/{:03}", libusb_get_bus_number(device),
                     libusb_get_device_address(device));
}

/// The device, opened; else an error that says what is there instead.
Result<Handle> find_device(libusb_context* context, const config::UsbIdentity& identity,
                           const std::string& name) {
  libusb_device** list = nullptr;
  const ssize_t count = libusb_get_device_list(context, &list);
  const std::unique_ptr<libusb_device*, void (*)(libusb_device**)> owned(
      list, [](libusb_device** all) { libusb_free_device_list(all, 1); });
  std::string others;
  for (ssize_t i = 0; i < count; ++i) {
    libusb_device_descriptor descriptor{};
    libusb_get_device_descriptor(list[i], &descriptor);
    if (descriptor.idVendor != identity.vendor || descriptor.idProduct != identity.product) {
      continue;
    }
    libusb_device_handle* opened = nullptr;
    const int code = libusb_open(list[i], &opened);
    Handle handle(opened);
    const std::string serial =
        code == 0 ? serial_of(opened, descriptor.iSerialNumber)
                  : fmt::format("one that cannot be opened ({})", libusb_strerror(code));
    if (code == 0 && serial == identity.serial) return handle;
    others += (others.empty() ? "; there is " : ", ") + serial;
  }
  return Error{ErrorCode::kUnplugged, name + " is not there" + others};
}

}  // namespace

std::string name_of(const config::UsbIdentity& identity) {
  return fmt::format("USB device {:#06x}:{:#06x} with the serial number {}", identity.vendor,
                     identity.product, identity.serial);
}

Result<std::unique_ptr<UsbBulk>> open_libusb_device(const config::UsbIdentity& identity) {
  const std::string name = name_of(identity);
  libusb_context* made = nullptr;
  if (const int code = libusb_init(&made); code != 0) {
    return Error{ErrorCode::kUnplugged, fmt::format("no USB here: {}", libusb_strerror(code))};
  }
  Context context(made);
  auto handle = find_device(made, identity, name);
  if (!handle) return handle.error();
  const auto interface = find_interface(libusb_get_device(handle->get()));
  if (!interface) return Error{ErrorCode::kUnplugged, name + " has no USBTMC interface"};
  libusb_set_auto_detach_kernel_driver(handle->get(), 1);
  if (const int code = libusb_claim_interface(handle->get(), interface->number); code != 0) {
    if (code == LIBUSB_ERROR_BUSY) return held(name, holder_of(node_of(handle->get())));
    return Error{ErrorCode::kUnplugged,
                 fmt::format("{} cannot be claimed: {}", name, libusb_strerror(code))};
  }
  return Result<std::unique_ptr<UsbBulk>>(
      std::make_unique<LibusbDevice>(std::move(context), std::move(*handle), *interface));
}

}  // namespace fogbench::drivers
