#pragma once
// Numbers in the bytes of a protocol, big-endian (USB/IP, Modbus) and little-endian (USB).

#include <cstdint>
#include <span>
#include <vector>

#include "drivers/number_codec.hpp"

namespace fogbench::simulator {

using Bytes = std::vector<std::uint8_t>;
using ByteView = std::span<const std::uint8_t>;

inline void append(Bytes& out, std::uint32_t value, std::size_t count, drivers::ByteOrder order) {
  out.resize(out.size() + count);
  drivers::store_bytes(out.data() + out.size() - count, count, order, value);
}
inline void append_be16(Bytes& out, std::uint16_t value) {
  append(out, value, 2, drivers::ByteOrder::kBigEndian);
}
inline void append_be32(Bytes& out, std::uint32_t value) {
  append(out, value, 4, drivers::ByteOrder::kBigEndian);
}
inline void append_le16(Bytes& out, std::uint16_t value) {
  append(out, value, 2, drivers::ByteOrder::kLittleEndian);
}
inline void append_le32(Bytes& out, std::uint32_t value) {
  append(out, value, 4, drivers::ByteOrder::kLittleEndian);
}
inline void append(Bytes& out, ByteView more) {
  out.insert(out.end(), more.begin(), more.end());
}

// Precondition of the four below: the bytes hold the number.
inline std::uint16_t be16_at(ByteView bytes, std::size_t offset) {
  return static_cast<std::uint16_t>(
      drivers::load_bytes(bytes.data() + offset, 2, drivers::ByteOrder::kBigEndian));
}
inline std::uint32_t be32_at(ByteView bytes, std::size_t offset) {
  return drivers::load_bytes(bytes.data() + offset, 4, drivers::ByteOrder::kBigEndian);
}
inline std::uint16_t le16_at(ByteView bytes, std::size_t offset) {
  return static_cast<std::uint16_t>(
      drivers::load_bytes(bytes.data() + offset, 2, drivers::ByteOrder::kLittleEndian));
}
inline std::uint32_t le32_at(ByteView bytes, std::size_t offset) {
  return drivers::load_bytes(bytes.data() + offset, 4, drivers::ByteOrder::kLittleEndian);
}

}  // namespace fogbench::simulator
