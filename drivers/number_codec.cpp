#include "drivers/number_codec.hpp"

#include <fmt/format.h>

#include <array>
#include <cassert>
#include <cmath>
#include <limits>

namespace fogbench::drivers {
namespace {

struct TypeInfo {
  std::string_view name;
  std::size_t bytes;
  double lowest;
  double highest;
};

/// In the order of NumberType.
constexpr std::array<TypeInfo, 7> kTypes{{
    {"uint8", 1, 0.0, 255.0},
    {"int8", 1, -128.0, 127.0},
    {"uint16", 2, 0.0, 65535.0},
    {"int16", 2, -32768.0, 32767.0},
    {"uint32", 4, 0.0, 4294967295.0},
    {"int32", 4, -2147483648.0, 2147483647.0},
    {"float32", 4, -static_cast<double>(std::numeric_limits<float>::max()),
     static_cast<double>(std::numeric_limits<float>::max())},
}};

const TypeInfo& info(NumberType type) {
  return kTypes[static_cast<std::size_t>(type)];
}

/// Puts "field_x: " or "register target: " and the value in front of a codec's message.
Error of_number(std::string_view what, std::string_view name, double value, std::string_view unit,
                const Error& error) {
  return {error.code, fmt::format("{} {} = {} {}: {}", what, name, value, unit, error.message)};
}

}  // namespace

std::size_t byte_count(NumberType type) {
  return info(type).bytes;
}
std::size_t word_count(NumberType type) {
  return info(type).bytes == 4 ? 2 : 1;
}
std::string_view name_of(NumberType type) {
  return info(type).name;
}

Result<double> number_from_bits(NumberType type, std::uint32_t bits) {
  const double number = raw_from_bits(type, bits);
  if (!std::isfinite(number)) {
    return Error{ErrorCode::kProtocol, fmt::format("reads {}, expected a finite number", number)};
  }
  return number;
}

Result<std::uint32_t> bits_from_number(NumberType type, double raw) {
  const double rounded = type == NumberType::kFloat32 ? raw : std::nearbyint(raw);
  const auto [name, bytes, lowest, highest] = info(type);
  if (!(rounded >= lowest && rounded <= highest)) {  // written so that a NaN fails
    return Error{ErrorCode::kLimit,
                 fmt::format("{} does not fit {} ({} ... {})", raw, name, lowest, highest)};
  }
  if (type == NumberType::kFloat32) return std::bit_cast<std::uint32_t>(static_cast<float>(raw));
  return static_cast<std::uint32_t>(static_cast<std::int64_t>(rounded));
}

Result<double> read_field(const FieldSpec& field, ByteOrder order,
                          std::span<const std::uint8_t> report) {
  const std::size_t count = byte_count(field.type);
  if (field.offset_bytes + count > report.size()) {
    return Error{ErrorCode::kProtocol,
                 fmt::format("{}: lies at bytes {} ... {}, found {} bytes", field.name,
                             field.offset_bytes, field.offset_bytes + count - 1, report.size())};
  }
  const auto raw =
      number_from_bits(field.type, load_bytes(report.data() + field.offset_bytes, count, order));
  if (!raw) return Error{raw.error().code, field.name + ": " + raw.error().message};
  return *raw * field.scale + field.offset;
}

Status write_field(const FieldSpec& field, ByteOrder order, double value,
                   std::span<std::uint8_t> report) {
  const std::size_t count = byte_count(field.type);
  assert(field.offset_bytes + count <= report.size());
  const auto bits = bits_from_number(field.type, (value - field.offset) / field.scale);
  if (!bits) return of_number("field", field.name, value, field.unit, bits.error());
  store_bytes(report.data() + field.offset_bytes, count, order, *bits);
  return {};
}

Result<double> read_words(const RegisterSpec& spec, std::span<const std::uint16_t> words) {
  assert(words.size() == word_count(spec.type));
  std::uint32_t bits = words[0];
  if (words.size() == 2) {
    const bool high_first = spec.word_order == WordOrder::kHighFirst;
    bits = std::uint32_t{words[high_first ? 0 : 1]} << 16 | words[high_first ? 1 : 0];
  }
  const auto raw = number_from_bits(spec.type, bits);
  if (!raw) {
    return Error{raw.error().code, fmt::format("register {} at {}: {}", spec.name, spec.address,
                                               raw.error().message)};
  }
  return *raw * spec.scale + spec.offset;
}

Status write_words(const RegisterSpec& spec, double value, std::span<std::uint16_t> words) {
  assert(words.size() == word_count(spec.type));
  const auto bits = bits_from_number(spec.type, (value - spec.offset) / spec.scale);
  if (!bits) return of_number("register", spec.name, value, spec.unit, bits.error());
  // A negative int8 fills its register with the sign, as a controller's own 16-bit arithmetic does.
  const auto low = static_cast<std::uint16_t>(*bits);
  if (words.size() == 1) {
    words[0] = low;
    return {};
  }
  const auto high = static_cast<std::uint16_t>(*bits >> 16);
  const bool high_first = spec.word_order == WordOrder::kHighFirst;
  words[0] = high_first ? high : low;
  words[1] = high_first ? low : high;
  return {};
}

}  // namespace fogbench::drivers
