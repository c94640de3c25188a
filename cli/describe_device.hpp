#pragma once
// An instrument's description as a person checks it: every quantity with its place, unit and
// limits.

#include <string>

#include "config/device.hpp"

namespace fogbench::cli {

/// "modbus", "scpi", "hid" or "frame", as the file says it.
std::string kind_of(const config::DeviceFile& device);

/// Several lines, each ended.
std::string describe(const config::DeviceFile& device);

}  // namespace fogbench::cli
