#pragma once
// The frame layout of the KVH 1750 IMU family, and a frame of it that is known to be good.

#include <cstdint>
#include <cstdlib>
#include <vector>

#include "config/device.hpp"
#include "drivers/crc.hpp"
#include "drivers/number_codec.hpp"

namespace fogbench::support {

/// 36 bytes: header, six big-endian floats, status, sequence 0 ... 127, int16 whole degC, and a
/// CRC-32/MPEG-2 over the first 32. The z rate is taken, rad/s to deg/h.
inline config::FrameDevice kvh_device() {
  using config::NumberType;
  constexpr double kDegPerHourPerRadPerS = 180.0 / 3.14159265358979323846 * 3600.0;
  config::FrameDevice device;
  device.name = "KVH 1750 layout";
  device.header = {0xfe, 0x81, 0xff, 0x55};
  device.frame_bytes = 36;
  device.rate = {.name = "rate",
                 .offset_bytes = 12,
                 .type = NumberType::kFloat32,
                 .scale = kDegPerHourPerRadPerS,
                 .unit = "deg/h"};
  device.temperature = config::FieldSpec{
      .name = "temperature", .offset_bytes = 30, .type = NumberType::kInt16, .unit = "degC"};
  device.status_offset_bytes = 28;
  device.status_valid_mask = 0x77;  // gyro and accelerometer x, y, z valid
  device.sequence_offset_bytes = 29;
  device.crc = {.polynomial = 0x04c11db7,
                .initial = 0xffffffff,
                .first_byte = 0,
                .count_bytes = 32,
                .offset_bytes = 32};
  return device;
}

/// Sequence 61, status 0x77, 40 degC.
inline std::vector<std::uint8_t> known_good_frame() {
  return {0xfe, 0x81, 0xff, 0x55, 0x37, 0xa9, 0x6a, 0x6e, 0x38, 0x58, 0x6c, 0x1f,
          0xb7, 0x5b, 0xf8, 0x62, 0xbf, 0x80, 0x3e, 0x78, 0xbb, 0x65, 0x0d, 0x28,
          0x3b, 0x0a, 0x37, 0xac, 0x77, 0x3d, 0x00, 0x28, 0x4b, 0xfa, 0x34, 0xd8};
}

/// A good frame with this sequence number and rate; the other numbers stand still.
inline std::vector<std::uint8_t> kvh_frame(std::int64_t sequence, double rate_deg_per_h,
                                           std::uint8_t status = 0x77) {
  static const config::FrameDevice device = kvh_device();
  static const drivers::Crc crc(device.crc);
  std::vector<std::uint8_t> frame = known_good_frame();
  const Status written =
      drivers::write_field(device.rate, device.byte_order, rate_deg_per_h, frame);
  if (!written) std::abort();
  frame[*device.status_offset_bytes] = status;
  frame[device.sequence_offset_bytes] =
      static_cast<std::uint8_t>(sequence % static_cast<std::int64_t>(device.sequence_modulus));
  crc.store(frame.data());
  return frame;
}

}  // namespace fogbench::support
