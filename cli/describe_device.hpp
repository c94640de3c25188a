#pragma once
// An instrument's description as a person checks it: every quantity with its place, unit and
// limits.

#include <string>

#include "config/device.hpp"
#include "config/device_file.hpp"
#include "config/result.hpp"

namespace fogbench::cli {

/// A device file, or the name of a ready one. All problems but the last are printed, a line each;
/// the last one is the error.
Result<config::DeviceFile> read_device(const std::string& name);

/// Several lines, each ended.
std::string description_text(const config::DeviceFile& device);

}  // namespace fogbench::cli
