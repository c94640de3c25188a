#pragma once
// HID instruments, by hidapi on the kernel's hidraw.

#include <memory>

#include "config/connection.hpp"
#include "config/result.hpp"
#include "drivers/clock.hpp"
#include "drivers/transport.hpp"

namespace fogbench::drivers {

/// Opens the device with this serial number. The kernel keeps up to 64 reports, which may be as old
/// as the last read: they are thrown away, so a report is one that came during the call. When the
/// device is pulled, calls return kUnplugged until one with the same serial number is there again.
/// `clock` must outlive the port. Errors: kUnplugged, which says what is there instead.
Result<std::unique_ptr<HidTransport>> open_hid(const config::HidConnection& connection,
                                               Clock& clock);

}  // namespace fogbench::drivers
