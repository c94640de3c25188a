#pragma once
// The JSON shape of a device file (device_file.hpp).

#include "config/codec.hpp"
#include "config/device_file.hpp"

namespace fogbench::config {

/// One of the kinds, by its key "kind".
template <>
struct Codec<DeviceFile> {
  static bool read(const Place& at, DeviceFile& out, const Rule& rule);
  static ordered_json schema(const Rule& rule);
  static ordered_json write(const DeviceFile& device);
};

}  // namespace fogbench::config
