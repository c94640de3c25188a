#pragma once

#include <memory>

#include "config/connection.hpp"
#include "config/result.hpp"
#include "drivers/usbtmc.hpp"

namespace fogbench::drivers {

/// The USBTMC interface of the device with these ids and this serial number, claimed. Errors:
/// kUnplugged, which names the serial numbers that are there, or says that access is denied.
Result<std::unique_ptr<UsbBulk>> open_libusb_device(const config::UsbIdentity& identity);

}  // namespace fogbench::drivers
