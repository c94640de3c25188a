#include "drivers/hid_port.hpp"

#include <fmt/format.h>
#include <hidapi.h>

#include <algorithm>
#include <array>
#include <string>

#include "drivers/deadline.hpp"
#include "drivers/process_lock.hpp"
#include "drivers/reconnect.hpp"

namespace fogbench::drivers {
namespace {

/// Twice what hidraw keeps: a device that fills it faster than this is read is broken.
constexpr int kMostQueued = 128;

struct HidCloser {
  void operator()(hid_device* device) const { hid_close(device); }
};
struct HidDevice {
  std::unique_ptr<hid_device, HidCloser> handle;
};

/// Serial numbers are ASCII; whatever else a device says becomes a question mark.
std::string narrow(const wchar_t* text) {
  std::string narrow;
  for (; text != nullptr && *text != 0; ++text) {
    narrow += *text >= 0x20 && *text < 0x7F ? static_cast<char>(*text) : '?';
  }
  return narrow;
}

Result<std::unique_ptr<HidDevice>> open_device(const config::UsbIdentity& identity,
                                               const std::string& name) {
  const std::unique_ptr<hid_device_info, decltype(&hid_free_enumeration)> all(
      hid_enumerate(identity.vendor, identity.product), hid_free_enumeration);
  std::string others;
  for (const hid_device_info* each = all.get(); each != nullptr; each = each->next) {
    const std::string serial = narrow(each->serial_number);
    if (serial != identity.serial) {
      others += (others.empty() ? "; there is " : ", ") + serial;
      continue;
    }
    auto device = std::make_unique<HidDevice>();
    device->handle.reset(hid_open_path(each->path));
    if (device->handle) return device;
    return Error{ErrorCode::kUnplugged, fmt::format("{} cannot be opened at {}: {}", name,
                                                    each->path, narrow(hid_error(nullptr)))};
  }
  return Error{ErrorCode::kUnplugged, name + " is not there" + others};
}

class HidPort final : public HidTransport {
 public:
  HidPort(std::string name, const config::HidConnection& connection, InstrumentLock lock,
          Clock& clock)
      : name_(std::move(name)),
        lock_(std::move(lock)),
        device_(clock, [this, connection] { return open_device(connection, name_); }) {}

  Result<std::size_t> read_report(std::span<std::uint8_t> out, Clock::Duration timeout) override {
    const auto device = device_.get();
    if (!device) return device.error();
    hid_device* handle = (*device)->handle.get();
    const Deadline deadline(timeout);
    std::array<std::uint8_t, 4096> report;
    for (int queued = 0;; ++queued) {
      const int count = hid_read_timeout(handle, report.data(), report.size(), 0);
      if (count < 0) return lost(handle);
      if (count == 0) break;
      if (queued == kMostQueued) {
        return Error{ErrorCode::kProtocol, name_ + " sends faster than it can be read"};
      }
    }
    const int count = hid_read_timeout(handle, report.data(), report.size(), deadline.left_ms());
    if (count < 0) return lost(handle);
    if (count == 0) return Error{ErrorCode::kTimeout, "no report from " + name_};
    const auto size = static_cast<std::size_t>(count);
    std::copy_n(report.begin(), std::min(size, out.size()), out.begin());
    return size;
  }

  Status write_report(std::span<const std::uint8_t> report) override {
    const auto device = device_.get();
    if (!device) return device.error();
    if (hid_write((*device)->handle.get(), report.data(), report.size()) < 0) {
      return lost((*device)->handle.get());
    }
    return {};
  }

 private:
  Error lost(hid_device* handle) {
    const std::string why = narrow(hid_error(handle));
    device_.lost();
    return {ErrorCode::kUnplugged, fmt::format("{} is gone: {}", name_, why)};
  }

  std::string name_;
  InstrumentLock lock_;
  Reconnecting<HidDevice> device_;
};

}  // namespace

Result<std::unique_ptr<HidTransport>> open_hid(const config::HidConnection& connection,
                                               Clock& clock) {
  std::string name = fmt::format("HID device {:#06x}:{:#06x} with the serial number {}",
                                 connection.vendor, connection.product, connection.serial);
  // hidraw hands every report to everybody who has the device open, and takes all of theirs.
  auto lock = lock_instrument({name});
  if (!lock) return lock.error();
  return Result<std::unique_ptr<HidTransport>>(
      std::make_unique<HidPort>(std::move(name), connection, std::move(*lock), clock));
}

}  // namespace fogbench::drivers
