#pragma once
// USBTMC instruments, by libusb.

#include <memory>

#include "config/connection.hpp"
#include "config/result.hpp"
#include "drivers/clock.hpp"
#include "drivers/transport.hpp"

namespace fogbench::drivers {

/// The device with this serial number. The first call claims its USBTMC interface, from the
/// kernel's own driver where it has it, and clears whatever is under way on it. While no device
/// with the serial number is there, calls return kUnplugged, which says what is there instead.
/// `clock` must outlive the port. Errors: kHeld.
Result<std::unique_ptr<MessageTransport>> open_usbtmc(const config::UsbConnection& connection,
                                                      Clock& clock);

}  // namespace fogbench::drivers
