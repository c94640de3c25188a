#pragma once

#include <memory>
#include <string>

#include "config/connection.hpp"
#include "config/result.hpp"
#include "drivers/usbtmc.hpp"

namespace fogbench::drivers {

/// "USB device 0x0957:0x1234 with the serial number BOP0001".
std::string name_of(const config::UsbIdentity& identity);

/// The USBTMC interface of the device with these ids and this serial number, claimed. Errors:
/// kUnplugged, which names the serial numbers that are there, or says that access is denied; kHeld
/// when another process has claimed it.
Result<std::unique_ptr<UsbBulk>> open_libusb_device(const config::UsbIdentity& identity);

}  // namespace fogbench::drivers
