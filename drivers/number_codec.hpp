#pragma once
// The one place that knows how a number lies in bytes or in Modbus registers. Drivers decode with
// it and the far ends of the simulated bench encode with it, and the other way round.
//
// value = raw * scale + offset, where raw is what the NumberType can hold. Integers are rounded to
// the nearest on the way out. All functions are pure and may be called from any thread.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

#include "config/device.hpp"
#include "config/result.hpp"

namespace fogbench::drivers {

using config::ByteOrder;
using config::FieldSpec;
using config::NumberType;
using config::RegisterSpec;
using config::WordOrder;

static_assert(std::endian::native == std::endian::little, "the byte order below is resolved here");

std::size_t byte_count(NumberType type);
/// Modbus registers that a number takes; an 8-bit number takes a whole one.
std::size_t word_count(NumberType type);
std::string_view name_of(NumberType type);  ///< "int16", "float32", as the device files say it

/// The number that the low bits hold; a float may be a NaN or an infinity.
inline double raw_from_bits(NumberType type, std::uint32_t bits) {
  switch (type) {
    case NumberType::kUint8:
      return static_cast<std::uint8_t>(bits);
    case NumberType::kInt8:
      return static_cast<std::int8_t>(bits);
    case NumberType::kUint16:
      return static_cast<std::uint16_t>(bits);
    case NumberType::kInt16:
      return static_cast<std::int16_t>(bits);
    case NumberType::kUint32:
      return bits;
    case NumberType::kInt32:
      return static_cast<std::int32_t>(bits);
    case NumberType::kFloat32:
      break;
  }
  return static_cast<double>(std::bit_cast<float>(bits));
}
/// The same; kProtocol for a NaN or an infinity.
Result<double> number_from_bits(NumberType type, std::uint32_t bits);
/// kLimit when the rounded number does not fit the type, or is not finite.
Result<std::uint32_t> bits_from_number(NumberType type, double raw);

/// Reads the field out of the report or frame that it lies in.
/// kProtocol when the report is too short, or for a NaN or an infinity; the message names the
/// field.
Result<double> read_field(const FieldSpec& field, ByteOrder order,
                          std::span<const std::uint8_t> report);
/// Writes the field into the report or frame. kLimit when the value does not fit; the message names
/// the field, the value and the unit. Precondition: the report holds the field.
Status write_field(const FieldSpec& field, ByteOrder order, double value,
                   std::span<std::uint8_t> report);

/// Reads a register's value from its own words. kProtocol for a NaN or an infinity.
/// Precondition: words.size() == word_count(type).
Result<double> read_words(const RegisterSpec& spec, std::span<const std::uint16_t> words);
/// Writes a value to a register's own words. kLimit when it does not fit.
/// Precondition: words.size() == word_count(type).
Status write_words(const RegisterSpec& spec, double value, std::span<std::uint16_t> words);

/// Unsigned integers of 1, 2 or 4 bytes at `bytes`, which need not be aligned.
inline std::uint32_t load_bytes(const std::uint8_t* bytes, std::size_t count, ByteOrder order) {
  const bool swap = order == ByteOrder::kBigEndian;
  if (count == 1) return *bytes;
  if (count == 2) {
    std::uint16_t word = 0;
    std::memcpy(&word, bytes, sizeof word);
    return swap ? __builtin_bswap16(word) : word;
  }
  std::uint32_t word = 0;
  std::memcpy(&word, bytes, sizeof word);
  return swap ? __builtin_bswap32(word) : word;
}
inline void store_bytes(std::uint8_t* bytes, std::size_t count, ByteOrder order,
                        std::uint32_t bits) {
  const bool swap = order == ByteOrder::kBigEndian;
  if (count == 1) {
    *bytes = static_cast<std::uint8_t>(bits);
  } else if (count == 2) {
    const auto low = static_cast<std::uint16_t>(bits);
    const std::uint16_t word = swap ? __builtin_bswap16(low) : low;
    std::memcpy(bytes, &word, sizeof word);
  } else {
    const std::uint32_t word = swap ? __builtin_bswap32(bits) : bits;
    std::memcpy(bytes, &word, sizeof word);
  }
}

}  // namespace fogbench::drivers
