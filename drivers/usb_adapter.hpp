#pragma once

#include <filesystem>
#include <string>

namespace fogbench::drivers {

/// Which USB adapter makes this serial line: "0403:6001 serial A600XYZ", or "1a86:7523 at 1-2.3"
/// (its place) for one without a serial number. Empty for a line that is on no USB. /dev/ttyUSB0 is
/// whichever adapter was plugged in first, so a port that finds its line again asks this.
std::string usb_adapter_of(const std::filesystem::path& tty,
                           const std::filesystem::path& sys = "/sys");

}  // namespace fogbench::drivers
