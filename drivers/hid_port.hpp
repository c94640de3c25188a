#pragma once
// HID instruments, by hidapi on the kernel's hidraw.

#include <memory>

#include "config/connection.hpp"
#include "config/result.hpp"
#include "drivers/clock.hpp"
#include "drivers/transport.hpp"

namespace fogbench::drivers {

/// The device with this serial number, which the first call opens. The kernel keeps up to 64
/// reports, which may be as old as the last read: they are thrown away, so a report is one that
/// came during the call. While no device with the serial number is there, calls return kUnplugged,
/// which says what is there instead. `clock` must outlive the port. Errors: kHeld.
Result<std::unique_ptr<HidTransport>> open_hid(const config::HidConnection& connection,
                                               Clock& clock);

}  // namespace fogbench::drivers
