#pragma once
// One description of any instrument, as a file of config/devices/ has it; its key "kind" says
// which.

#include <filesystem>
#include <string_view>
#include <variant>
#include <vector>

#include "config/device.hpp"
#include "config/result.hpp"
#include "config/sensor.hpp"

namespace fogbench::config {

using DeviceFile = std::variant<ModbusDevice, ScpiDevice, HidDevice, FrameDevice, ModbusSensor,
                                ScpiSensor, HidSensor, LineSensor>;
/// Its key "kind".
std::string_view kind_of(const DeviceFile& device);

/// Reads and checks one instrument description.
/// Errors: kBadInput, one line with the file and the JSON pointer.
Result<DeviceFile> load_device(const std::filesystem::path& file);

/// The same, with every error at once instead of the first; empty when `out` has been read.
std::vector<Error> check_device(const std::filesystem::path& file, DeviceFile& out);

}  // namespace fogbench::config
