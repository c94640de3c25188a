#include "drivers/crc.hpp"

#include <gtest/gtest.h>

#include <string_view>
#include <vector>

#include "tests/support/kvh_frame.hpp"

namespace fogbench::drivers {
namespace {

std::vector<std::uint8_t> bytes_of(std::string_view text) {
  return {text.begin(), text.end()};
}

/// The definition, one bit at a time, as the fast tables must not be.
std::uint32_t bit_by_bit(const config::CrcSpec& spec, std::span<const std::uint8_t> bytes) {
  const std::uint64_t top = 1ull << (spec.width_bits - 1);
  const std::uint64_t mask = (top << 1) - 1;
  std::uint64_t state = spec.initial;
  const auto reversed = [](std::uint64_t value, int bits) {
    std::uint64_t result = 0;
    for (int i = 0; i < bits; ++i) result = result << 1 | (value >> i & 1);
    return result;
  };
  for (const std::uint8_t byte : bytes) {
    state ^= (spec.reflected ? reversed(byte, 8) : byte) << (spec.width_bits - 8);
    for (int bit = 0; bit < 8; ++bit) {
      state = (state & top ? state << 1 ^ spec.polynomial : state << 1) & mask;
    }
  }
  if (spec.reflected) state = reversed(state, spec.width_bits);
  return static_cast<std::uint32_t>(state) ^ spec.final_xor;
}

struct Known {
  const char* name;
  config::CrcSpec spec;
  std::uint32_t check;  ///< of "123456789", from the catalogue of parametrised CRC algorithms
};

const Known kKnown[] = {
    {"CRC-32/MPEG-2", {.polynomial = 0x04c11db7, .initial = 0xffffffff}, 0x0376e6e7},
    {"CRC-32/ISO-HDLC",
     {.polynomial = 0x04c11db7, .initial = 0xffffffff, .final_xor = 0xffffffff, .reflected = true},
     0xcbf43926},
    {"CRC-16/MODBUS",
     {.width_bits = 16, .polynomial = 0x8005, .initial = 0xffff, .reflected = true},
     0x4b37},
    {"CRC-16/XMODEM", {.width_bits = 16, .polynomial = 0x1021}, 0x31c3},
    {"CRC-16/MCRF4XX",
     {.width_bits = 16, .polynomial = 0x1021, .initial = 0xffff, .reflected = true},
     0x6f91},
    // Its initial value is not a palindrome, so it tells whether that is reflected too.
    {"CRC-16/ISO-IEC-14443-3-A",
     {.width_bits = 16, .polynomial = 0x1021, .initial = 0xc6c6, .reflected = true},
     0xbf05},
    {"CRC-8/SMBUS", {.width_bits = 8, .polynomial = 0x07}, 0xf4},
    {"CRC-8/MAXIM-DOW", {.width_bits = 8, .polynomial = 0x31, .reflected = true}, 0xa1},
};

TEST(Crc, GivesThePublishedCheckValues) {
  for (const Known& known : kKnown) {
    EXPECT_EQ(Crc(known.spec).of(bytes_of("123456789")), known.check) << known.name;
  }
}

TEST(Crc, AgreesWithTheDefinitionAtEveryLength) {
  std::vector<std::uint8_t> bytes;
  for (std::uint32_t i = 0; i < 70; ++i) {
    for (const Known& known : kKnown) {
      EXPECT_EQ(Crc(known.spec).of(bytes), bit_by_bit(known.spec, bytes))
          << known.name << " of " << i << " bytes";
    }
    bytes.push_back(static_cast<std::uint8_t>(i * 37 + 11));
  }
}

TEST(Crc, HoldsForTheKnownGoodFrameAndForNoneWithAFlippedBit) {
  const Crc crc(support::kvh_device().crc);
  auto frame = support::known_good_frame();
  EXPECT_TRUE(crc.holds(frame.data()));
  for (std::size_t bit = 0; bit < frame.size() * 8; ++bit) {
    frame[bit / 8] = static_cast<std::uint8_t>(frame[bit / 8] ^ 1 << bit % 8);
    EXPECT_FALSE(crc.holds(frame.data())) << "bit " << bit;
    frame[bit / 8] = static_cast<std::uint8_t>(frame[bit / 8] ^ 1 << bit % 8);
  }
}

TEST(Crc, StoresWhatItHolds) {
  const Crc crc(support::kvh_device().crc);
  auto frame = support::known_good_frame();
  const auto good = frame;
  frame[32] = frame[33] = frame[34] = frame[35] = 0;
  crc.store(frame.data());
  EXPECT_EQ(frame, good);
}

}  // namespace
}  // namespace fogbench::drivers
