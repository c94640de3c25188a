#include "drivers/number_codec.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

namespace fogbench::drivers {
namespace {

constexpr NumberType kAll[] = {NumberType::kUint8,  NumberType::kInt8,   NumberType::kUint16,
                               NumberType::kInt16,  NumberType::kUint32, NumberType::kInt32,
                               NumberType::kFloat32};

struct Range {
  NumberType type;
  double lowest, highest;
};
constexpr Range kIntegers[] = {
    {NumberType::kUint8, 0, 255},           {NumberType::kInt8, -128, 127},
    {NumberType::kUint16, 0, 65535},        {NumberType::kInt16, -32768, 32767},
    {NumberType::kUint32, 0, 4294967295.0}, {NumberType::kInt32, -2147483648.0, 2147483647.0}};

TEST(NumberCodec, WritesTheBytesOfEitherOrder) {
  std::array<std::uint8_t, 6> report{};
  const FieldSpec field{.name = "x", .offset_bytes = 1, .type = NumberType::kInt32};
  ASSERT_TRUE(write_field(field, ByteOrder::kBigEndian, 0x01020304, report));
  EXPECT_EQ(report, (std::array<std::uint8_t, 6>{0, 1, 2, 3, 4, 0}));
  ASSERT_TRUE(write_field(field, ByteOrder::kLittleEndian, -2, report));
  EXPECT_EQ(report, (std::array<std::uint8_t, 6>{0, 0xfe, 0xff, 0xff, 0xff, 0}));
}

TEST(NumberCodec, ReadsBackWhatItWroteAtTheEdgesOfEveryType) {
  for (const auto& [type, lowest, highest] : kIntegers) {
    for (const double value : {lowest, 0.0, 1.0, highest}) {
      for (const ByteOrder order : {ByteOrder::kBigEndian, ByteOrder::kLittleEndian}) {
        std::array<std::uint8_t, 4> report{};
        const FieldSpec field{.name = "x", .type = type};
        ASSERT_TRUE(write_field(field, order, value, report));
        EXPECT_EQ(*read_field(field, order, report), value) << name_of(type);
      }
      for (const WordOrder order : {WordOrder::kHighFirst, WordOrder::kLowFirst}) {
        std::array<std::uint16_t, 2> words{};
        const std::span<std::uint16_t> own = std::span(words).first(word_count(type));
        const RegisterSpec spec{.name = "x", .type = type, .word_order = order};
        ASSERT_TRUE(write_words(spec, value, own));
        EXPECT_EQ(*read_words(spec, own), value) << name_of(type);
      }
    }
  }
}

TEST(NumberCodec, RefusesWhatDoesNotFit) {
  for (const auto& [type, lowest, highest] : kIntegers) {
    EXPECT_TRUE(bits_from_number(type, highest + 0.4));
    for (const double value : {lowest - 1, highest + 1, std::nan(""), HUGE_VAL}) {
      const auto bits = bits_from_number(type, value);
      ASSERT_FALSE(bits) << name_of(type) << ' ' << value;
      EXPECT_EQ(bits.error().code, ErrorCode::kLimit);
    }
  }
  EXPECT_FALSE(bits_from_number(NumberType::kFloat32, 1e39));
  EXPECT_FALSE(bits_from_number(NumberType::kFloat32, -HUGE_VAL));
}

TEST(NumberCodec, NamesWhatWasRefusedWithItsUnit) {
  std::array<std::uint16_t, 1> words{};
  const RegisterSpec spec{.name = "target", .scale = 0.1, .unit = "degC"};
  const Status status = write_words(spec, 4000.0, words);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kLimit);
  EXPECT_EQ(status.error().message,
            "register target = 4000 degC: 40000 does not fit int16 (-32768 ... 32767)");
}

TEST(NumberCodec, RoundsToTheNearestStepOfTheScale) {
  std::array<std::uint16_t, 1> words{};
  const RegisterSpec spec{.name = "t", .scale = 0.1, .offset = -20.0, .unit = "degC"};
  ASSERT_TRUE(write_words(spec, 31.26, words));
  EXPECT_EQ(words[0], 513);
  EXPECT_NEAR(*read_words(spec, words), 31.3, 1e-12);
}

TEST(NumberCodec, FloatsLieInTwoRegistersInEitherWordOrder) {
  std::array<std::uint16_t, 2> words{};
  RegisterSpec spec{.name = "t", .type = NumberType::kFloat32};
  ASSERT_TRUE(write_words(spec, 25.0, words));  // 0x41c80000
  EXPECT_EQ(words, (std::array<std::uint16_t, 2>{0x41c8, 0x0000}));
  spec.word_order = WordOrder::kLowFirst;
  // The tell-tale of a wrong word order: a temperature of the order of 1e-41.
  EXPECT_LT(std::abs(*read_words(spec, words)), 1e-30);
  ASSERT_TRUE(write_words(spec, 25.0, words));
  EXPECT_EQ(words, (std::array<std::uint16_t, 2>{0x0000, 0x41c8}));
}

TEST(NumberCodec, NanAndInfinityAreProtocolErrors) {
  for (const float value :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    const auto number = number_from_bits(NumberType::kFloat32, bits);
    ASSERT_FALSE(number);
    EXPECT_EQ(number.error().code, ErrorCode::kProtocol);

    std::array<std::uint8_t, 4> report{};
    store_bytes(report.data(), 4, ByteOrder::kBigEndian, bits);
    const auto field = read_field({.name = "field_x", .type = NumberType::kFloat32},
                                  ByteOrder::kBigEndian, report);
    ASSERT_FALSE(field);
    EXPECT_EQ(field.error().code, ErrorCode::kProtocol);
    EXPECT_EQ(field.error().message.find("field_x"), 0u);

    const std::array<std::uint16_t, 2> words{static_cast<std::uint16_t>(bits >> 16), 0};
    EXPECT_FALSE(read_words({.name = "t", .type = NumberType::kFloat32}, words));
  }
}

TEST(NumberCodec, AShortReportIsAProtocolError) {
  const std::array<std::uint8_t, 4> report{};
  const auto field = read_field({.name = "z", .offset_bytes = 2, .type = NumberType::kInt32},
                                ByteOrder::kBigEndian, report);
  ASSERT_FALSE(field);
  EXPECT_EQ(field.error().code, ErrorCode::kProtocol);
  EXPECT_EQ(field.error().message, "z: lies at bytes 2 ... 5, found 4 bytes");
}

TEST(NumberCodec, EveryTypeHasItsSizeAndName) {
  const std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 4};
  for (std::size_t i = 0; i < std::size(kAll); ++i) {
    EXPECT_EQ(byte_count(kAll[i]), sizes[i]);
    EXPECT_EQ(word_count(kAll[i]), sizes[i] == 4 ? 2u : 1u);
  }
  EXPECT_EQ(name_of(NumberType::kFloat32), "float32");
}

}  // namespace
}  // namespace fogbench::drivers
