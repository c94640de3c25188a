#include "record/chunk_codec.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace fogbench::record {
namespace {

drivers::GyroBlock noise(std::size_t frames, std::int64_t first) {
  std::mt19937_64 random(7);
  std::normal_distribution<float> rate(12.4F, 1.9F);
  drivers::GyroBlock block;
  for (std::size_t i = 0; i < frames; ++i) {
    block.index.push_back(first + static_cast<std::int64_t>(i));
    block.rate_deg_per_h.push_back(rate(random));
    block.temperature_c.push_back(i < frames / 2 ? 21.0F : 22.0F);
  }
  return block;
}

Chunk encode(const drivers::GyroBlock& block) {
  ChunkEncoder encoder;
  const auto chunk = encoder.encode(block.index, block.rate_deg_per_h, block.temperature_c);
  EXPECT_TRUE(chunk);
  return **chunk;
}

void expect_round_trip(const drivers::GyroBlock& block) {
  drivers::GyroBlock out;
  const Status decoded = decode_chunk(encode(block), out);
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(out.index, block.index);
  EXPECT_EQ(out.rate_deg_per_h, block.rate_deg_per_h);
  EXPECT_EQ(out.temperature_c, block.temperature_c);
}

TEST(ChunkCodec, GivesBackEveryFrame) {
  expect_round_trip(noise(65536, 1'000'000'000'000));
}

TEST(ChunkCodec, GivesBackASingleFrame) {
  expect_round_trip(noise(1, 0));
}

TEST(ChunkCodec, GivesBackGaps) {
  drivers::GyroBlock block = noise(1000, 5);
  for (std::size_t i = 10; i < 1000; ++i) block.index[i] += 1;     // one frame lost
  for (std::size_t i = 500; i < 1000; ++i) block.index[i] += 127;  // a wrap of them
  block.index.back() += 3;
  expect_round_trip(block);
}

TEST(ChunkCodec, GivesBackEveryOtherFrame) {
  drivers::GyroBlock block = noise(4096, 0);
  for (std::size_t i = 0; i < 4096; ++i) block.index[i] = static_cast<std::int64_t>(2 * i);
  expect_round_trip(block);
}

TEST(ChunkCodec, KeepsTheBitsOfSpecialNumbers) {
  drivers::GyroBlock block;
  block.index = {0, 1, 2, 3};
  block.rate_deg_per_h = {std::numeric_limits<float>::quiet_NaN(), -0.0F,
                          std::numeric_limits<float>::infinity(),
                          std::numeric_limits<float>::denorm_min()};
  drivers::GyroBlock out;
  ASSERT_TRUE(decode_chunk(encode(block), out));
  EXPECT_TRUE(std::isnan(out.rate_deg_per_h[0]));
  EXPECT_TRUE(std::signbit(out.rate_deg_per_h[1]));
  EXPECT_EQ(out.rate_deg_per_h[2], block.rate_deg_per_h[2]);
  EXPECT_EQ(out.rate_deg_per_h[3], block.rate_deg_per_h[3]);
  EXPECT_TRUE(out.temperature_c.empty());
}

TEST(ChunkCodec, ARegularCounterAndASteadyTemperatureCostNothing) {
  const Chunk chunk = encode(noise(65536, 0));
  EXPECT_TRUE(chunk.index_runs.empty());
  EXPECT_LT(chunk.temperature.size(), 200U);
  EXPECT_LT(chunk.rate.size(), 65536U * 4 * 9 / 10);
}

TEST(ChunkCodec, AnEncoderForgetsTheChunkBefore) {
  ChunkEncoder encoder;
  drivers::GyroBlock gap = noise(100, 0);
  gap.index.back() += 5;
  ASSERT_TRUE(encoder.encode(gap.index, gap.rate_deg_per_h, gap.temperature_c));
  const drivers::GyroBlock block = noise(10, 0);
  const auto chunk = encoder.encode(block.index, block.rate_deg_per_h, {});
  ASSERT_TRUE(chunk);
  EXPECT_TRUE((*chunk)->index_runs.empty());
  EXPECT_TRUE((*chunk)->temperature.empty());
}

TEST(ChunkCodec, DetectsEveryFlippedBitTruncationAndFalseHead) {
  drivers::GyroBlock block = noise(64, 100);
  block.index.back() += 9;
  const Chunk good = encode(block);
  const auto expect_damaged = [](const Chunk& chunk, const std::string& what) {
    drivers::GyroBlock out;
    const Status status = decode_chunk(chunk, out);
    ASSERT_FALSE(status) << what;
    EXPECT_EQ(status.error().code, ErrorCode::kStore);
    EXPECT_TRUE(out.index.empty() && out.rate_deg_per_h.empty()) << what;
  };
  for (auto column : {&Chunk::index_runs, &Chunk::rate, &Chunk::temperature}) {
    for (std::size_t i = 0; i < (good.*column).size(); ++i) {
      for (const unsigned bit : {0U, 3U, 7U}) {
        Chunk bad = good;
        (bad.*column)[i] ^= std::byte{1} << bit;
        drivers::GyroBlock out;
        // zstd headers have bits that mean nothing: what is accepted must be the same content.
        if (decode_chunk(bad, out)) {
          EXPECT_EQ(out.index, block.index);
          EXPECT_EQ(out.rate_deg_per_h, block.rate_deg_per_h);
        }
      }
      Chunk cut = good;
      (cut.*column).resize(i);
      if (i > 0) expect_damaged(cut, "cut to " + std::to_string(i));
    }
  }
  Chunk bad = good;
  ++bad.first_index;
  expect_damaged(bad, "first index");
  bad = good;
  ++bad.frames;
  expect_damaged(bad, "frames");
  bad.frames = std::int64_t{1} << 60;
  expect_damaged(bad, "absurd frames");
  bad.frames = -1;
  expect_damaged(bad, "negative frames");
  bad = good;
  bad.sha256[31] ^= std::byte{1};
  expect_damaged(bad, "hash");
  bad = good;
  bad.index_runs.clear();
  expect_damaged(bad, "lost gap");
}

TEST(Sha256, AgreesWithThePublishedValue) {
  // FIPS 180-2, appendix B.1: "abc".
  const std::byte abc[] = {std::byte{'a'}, std::byte{'b'}, std::byte{'c'}};
  const Sha256 digest = sha256_of(abc);
  EXPECT_EQ(digest[0], std::byte{0xba});
  EXPECT_EQ(digest[1], std::byte{0x78});
  EXPECT_EQ(digest[31], std::byte{0xad});
}

}  // namespace
}  // namespace fogbench::record
