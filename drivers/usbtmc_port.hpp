#pragma once
// USBTMC instruments, by libusb.

#include <memory>

#include "config/connection.hpp"
#include "config/result.hpp"
#include "drivers/clock.hpp"
#include "drivers/transport.hpp"

namespace fogbench::drivers {

/// Claims the USBTMC interface of the device with this serial number, from the kernel's own driver
/// where it has it. When it is pulled, calls return kUnplugged until a device with the same serial
/// number is there again. `clock` must outlive the port. Errors: kUnplugged, which says what is
/// there instead.
Result<std::unique_ptr<MessageTransport>> open_usbtmc(const config::UsbConnection& connection,
                                                      Clock& clock);

}  // namespace fogbench::drivers
