#include "drivers/frame_parser.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "tests/support/kvh_frame.hpp"

namespace fogbench::drivers {
namespace {

using support::kvh_device;
using support::kvh_frame;
using Bytes = std::vector<std::uint8_t>;

void append(Bytes& bytes, const Bytes& more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

/// A parser and what came out of it.
struct Stream {
  explicit Stream(const config::FrameDevice& device = kvh_device()) : parser(device) {}

  void feed(const Bytes& bytes, std::size_t chunk = SIZE_MAX) {
    for (std::size_t at = 0; at < bytes.size();) {
      const std::span<std::byte> space = parser.space();
      const std::size_t count = std::min({chunk, space.size(), bytes.size() - at});
      std::memcpy(space.data(), bytes.data() + at, count);
      parser.parse(count, block);
      at += count;
    }
  }
  Stream& settle() {
    parser.settle(std::nullopt, block);
    return *this;
  }
  const StreamStatistics& statistics() const { return parser.statistics(); }

  FrameParser parser;
  GyroBlock block;
};

Bytes frames(std::int64_t first, std::int64_t count) {
  Bytes bytes;
  for (std::int64_t i = first; i < first + count; ++i) {
    append(bytes, kvh_frame(i, static_cast<double>(i)));
  }
  return bytes;
}

std::vector<std::int64_t> indexes(std::int64_t first, std::int64_t count) {
  std::vector<std::int64_t> result;
  for (std::int64_t i = first; i < first + count; ++i) result.push_back(i);
  return result;
}

TEST(FrameParser, ReadsTheKnownGoodFrame) {
  Stream stream;
  stream.feed(support::known_good_frame());
  stream.settle();
  ASSERT_EQ(stream.block.index, indexes(0, 1));
  // b7 5b f8 62 as a big-endian float is -1.3111248e-5 rad/s.
  EXPECT_NEAR(stream.block.rate_deg_per_h[0], -1.3111248e-5 * 206264.80625, 1e-5);
  EXPECT_EQ(stream.block.temperature_c, std::vector<float>{40.0f});
  EXPECT_EQ(stream.statistics().frames_good, 1u);
  EXPECT_EQ(stream.statistics().bytes_skipped, 0u);
}

TEST(FrameParser, FindsTheSameFramesHoweverTheReadsCutThem) {
  Bytes bytes = frames(0, 3);
  bytes.insert(bytes.begin() + 36, {0xfe, 0x81, 0xff, 0x55, 0xfe});  // a false header between
  Stream whole;
  whole.feed(bytes);
  whole.settle();
  ASSERT_EQ(whole.block.index, indexes(0, 3));
  for (std::size_t first = 0; first <= bytes.size(); ++first) {
    Stream cut;
    const auto middle = bytes.begin() + static_cast<std::ptrdiff_t>(first);
    cut.feed({bytes.begin(), middle});
    cut.feed({middle, bytes.end()});
    cut.settle();
    EXPECT_EQ(cut.block.index, whole.block.index) << "cut at " << first;
    EXPECT_EQ(cut.block.rate_deg_per_h, whole.block.rate_deg_per_h) << "cut at " << first;
    EXPECT_EQ(cut.statistics().bytes_skipped, 5u);
  }
  Stream bytewise;
  bytewise.feed(bytes, 1);
  EXPECT_EQ(bytewise.settle().block.index, whole.block.index);
}

TEST(FrameParser, FollowsTheSequenceThroughItsWrap) {
  Stream stream;
  stream.feed(frames(120, 300));
  stream.settle();
  EXPECT_EQ(stream.block.index, indexes(0, 300));
  EXPECT_EQ(stream.statistics().frames_missing, 0u);
}

TEST(FrameParser, CountsMissingFramesAcrossTheWrap) {
  Bytes bytes = frames(0, 126);
  append(bytes, frames(131, 4));  // 126 ... 130 are lost, the wrap among them
  Stream stream;
  stream.feed(bytes);
  stream.settle();
  EXPECT_EQ(stream.block.index.size(), 130u);
  EXPECT_EQ(stream.block.index[126], 131);
  EXPECT_EQ(stream.statistics().frames_missing, 5u);
}

TEST(FrameParser, RejectsARepeatedFrameEvenWithAnotherReading) {
  Bytes bytes = frames(0, 3);
  append(bytes, kvh_frame(2, 99.0));
  append(bytes, frames(3, 2));
  Stream stream;
  stream.feed(bytes);
  stream.settle();
  EXPECT_EQ(stream.block.index, indexes(0, 5));
  EXPECT_NEAR(stream.block.rate_deg_per_h[2], 2.0f, 1e-6f);
  EXPECT_EQ(stream.statistics().frames_repeated, 1u);
  EXPECT_EQ(stream.statistics().frames_good, 5u);
  EXPECT_EQ(stream.statistics().frames_missing, 0u);
}

TEST(FrameParser, DropsAFrameWithAWrongCheckValueAndKeepsItsNeighbours) {
  Bytes bytes = frames(0, 3);
  bytes[36 + 20] ^= 0x10;
  Stream stream;
  stream.feed(bytes);
  stream.settle();
  EXPECT_EQ(stream.block.index, (std::vector<std::int64_t>{0, 2}));
  EXPECT_EQ(stream.statistics().frames_bad_checksum, 1u);
  EXPECT_EQ(stream.statistics().frames_missing, 1u);
  EXPECT_EQ(stream.statistics().bytes_skipped, 36u);
}

TEST(FrameParser, DropsAFrameWhoseStatusOrRateIsInvalid) {
  Bytes bytes = frames(0, 1);
  append(bytes, kvh_frame(1, 1.0, 0x73));  // gyro z not valid
  Bytes nan = kvh_frame(2, 2.0);
  store_bytes(nan.data() + 12, 4, ByteOrder::kBigEndian,
              std::bit_cast<std::uint32_t>(std::numeric_limits<float>::quiet_NaN()));
  Crc(kvh_device().crc).store(nan.data());
  append(bytes, nan);
  Bytes beyond = kvh_frame(3, 3.0);
  beyond[29] = 200;  // no sequence number counts that far
  Crc(kvh_device().crc).store(beyond.data());
  append(bytes, beyond);
  append(bytes, frames(4, 1));
  Stream stream;
  stream.feed(bytes);
  stream.settle();
  EXPECT_EQ(stream.block.index, (std::vector<std::int64_t>{0, 4}));
  EXPECT_EQ(stream.statistics().frames_invalid, 3u);
  EXPECT_EQ(stream.statistics().frames_missing, 3u);
}

TEST(FrameParser, AFalseHeaderInThePayloadChangesNothing) {
  config::FrameDevice device = kvh_device();
  Bytes bytes;
  for (int i = 0; i < 5; ++i) {
    Bytes frame = kvh_frame(i, i);
    for (const std::size_t at : {4U, 16U, 24U}) {
      std::copy(device.header.begin(), device.header.end(),
                frame.begin() + static_cast<std::ptrdiff_t>(at));
    }
    Crc(device.crc).store(frame.data());
    append(bytes, frame);
  }
  // The first frame's own header is damaged: the search goes through its false ones.
  bytes[0] = 0;
  Stream stream;
  stream.feed(bytes);
  stream.settle();
  EXPECT_EQ(stream.block.index, indexes(0, 4));
  EXPECT_EQ(stream.statistics().frames_bad_checksum, 3u);
  EXPECT_EQ(stream.statistics().bytes_skipped, 36u);
}

TEST(FrameParser, AFrameWithoutTemperatureLeavesThatColumnEmpty) {
  config::FrameDevice device = kvh_device();
  device.temperature.reset();
  Stream stream(device);
  stream.feed(frames(0, 2));
  EXPECT_EQ(stream.settle().block.index, indexes(0, 2));
  EXPECT_TRUE(stream.block.temperature_c.empty());
}

TEST(FrameParser, ReadsLittleEndianIntegersAndShortHeaders) {
  config::FrameDevice device;
  device.header = {0xaa};
  device.frame_bytes = 9;
  device.byte_order = ByteOrder::kLittleEndian;
  device.rate = {
      .name = "rate", .offset_bytes = 1, .type = NumberType::kInt32, .scale = 0.001, .offset = 5.0};
  device.status_offset_bytes = 5;
  device.sequence_offset_bytes = 6;
  device.sequence_modulus = 256;
  device.crc = {.width_bits = 16, .polynomial = 0x1021, .count_bytes = 7, .offset_bytes = 7};
  ASSERT_TRUE(check_layout(device));
  Bytes bytes;
  for (std::uint8_t i = 0; i < 3; ++i) {
    Bytes frame{0xaa, 0, 0, 0, 0, 0, i, 0, 0};
    ASSERT_TRUE(write_field(device.rate, device.byte_order, -7.25, frame));
    Crc(device.crc).store(frame.data());
    append(bytes, frame);
  }
  Stream stream(device);
  stream.feed(bytes, 4);
  EXPECT_EQ(stream.settle().block.index, indexes(0, 3));
  EXPECT_NEAR(stream.block.rate_deg_per_h[1], -7.25f, 1e-6f);
}

TEST(FrameParser, CountsInSixteenBitsAndDoesWithoutAStatus) {
  config::FrameDevice device;
  device.header = {0xaa, 0x55};
  device.frame_bytes = 9;
  device.rate = {.name = "rate", .offset_bytes = 4, .type = NumberType::kInt16};
  device.sequence_offset_bytes = 2;
  device.sequence_type = NumberType::kUint16;
  device.sequence_modulus = 65536;
  device.crc = {.width_bits = 16, .polynomial = 0x1021, .count_bytes = 7, .offset_bytes = 7};
  ASSERT_TRUE(check_layout(device));
  Bytes bytes;
  for (const unsigned count : {65534U, 65535U, 0U, 300U, 301U}) {  // 1 ... 299 are lost
    Bytes frame{0xaa, 0x55, 0, 0, 0, 0, 0, 0, 0};
    store_bytes(frame.data() + 2, 2, device.byte_order, count);
    ASSERT_TRUE(write_field(device.rate, device.byte_order, count % 100, frame));
    Crc(device.crc).store(frame.data());
    append(bytes, frame);
  }
  Stream stream(device);
  stream.feed(bytes, 4);
  EXPECT_EQ(stream.settle().block.index, (std::vector<std::int64_t>{0, 1, 2, 302, 303}));
  EXPECT_EQ(stream.parser.statistics().frames_missing, 299U);
}

TEST(FrameParser, LayoutsThatCannotBeAreBadInput) {
  const auto refused = [](auto change) {
    config::FrameDevice device = kvh_device();
    change(device);
    const Status status = check_layout(device);
    return !status && status.error().code == ErrorCode::kBadInput;
  };
  EXPECT_TRUE(check_layout(kvh_device()));
  EXPECT_TRUE(refused([](auto& d) { d.header.clear(); }));
  EXPECT_TRUE(refused([](auto& d) { d.header.resize(9); }));
  EXPECT_TRUE(refused([](auto& d) { d.frame_bytes = 35; }));
  EXPECT_TRUE(refused([](auto& d) { d.rate.offset_bytes = 33; }));
  EXPECT_TRUE(refused([](auto& d) { d.temperature->offset_bytes = 35; }));
  EXPECT_TRUE(refused([](auto& d) { d.status_offset_bytes = 36; }));
  EXPECT_TRUE(refused([](auto& d) { d.sequence_offset_bytes = 36; }));
  EXPECT_TRUE(refused([](auto& d) { d.crc.count_bytes = 37; }));
  EXPECT_TRUE(refused([](auto& d) { d.crc.width_bits = 24; }));
  EXPECT_TRUE(refused([](auto& d) { d.sequence_modulus = 257; }));
  EXPECT_TRUE(refused([](auto& d) { d.sequence_modulus = 1; }));
  EXPECT_TRUE(refused([](auto& d) { d.frame_rate_hz = 0; }));
}

/// Streams with random damage: every undamaged frame comes out exactly once, in its place, and no
/// damaged one does, however the reads cut the stream.
TEST(FrameParser, EveryUndamagedFrameComesOutOnceAndNoDamagedOne) {
  std::mt19937_64 random(20261121);
  const auto below = [&](std::uint64_t limit) { return random() % limit; };
  for (int trial = 0; trial < 300; ++trial) {
    Bytes bytes;
    std::vector<std::int64_t> expected;
    for (std::int64_t i = 0; i < 400; ++i) {
      Bytes frame = kvh_frame(i, static_cast<double>(i));
      switch (i == 0 ? 99 : below(20)) {
        case 0:  // lost without a trace
          break;
        case 1:  // one bit
          frame[below(36)] ^= static_cast<std::uint8_t>(1u << below(8));
          append(bytes, frame);
          break;
        case 2:  // bytes lost out of it
          frame.erase(frame.begin() + static_cast<std::ptrdiff_t>(below(36)));
          append(bytes, frame);
          break;
        case 3:  // not valid
          append(bytes, kvh_frame(i, 0.0, static_cast<std::uint8_t>(~(1u << below(3)))));
          break;
        case 4:  // twice
          append(bytes, frame);
          append(bytes, frame);
          expected.push_back(i);
          break;
        case 5: {  // garbage with headers in it, then the frame
          Bytes garbage(below(80));
          for (std::uint8_t& byte : garbage) byte = static_cast<std::uint8_t>(random());
          if (garbage.size() > 8) std::copy_n(frame.begin(), 4, garbage.end() - 5);
          append(bytes, garbage);
          [[fallthrough]];
        }
        default:
          append(bytes, frame);
          expected.push_back(i);
      }
    }
    // A frame that was begun as a false header is only known once more bytes have come.
    bytes.insert(bytes.end(), 40, 0);
    Stream stream;
    stream.feed(bytes, 1 + below(200));
    stream.settle();
    ASSERT_EQ(stream.block.index, expected) << "trial " << trial;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      ASSERT_NEAR(stream.block.rate_deg_per_h[i], static_cast<double>(expected[i]), 1e-4);
    }
    const StreamStatistics& seen = stream.statistics();
    EXPECT_EQ(seen.frames_good, expected.size());
    EXPECT_EQ(seen.frames_good + seen.frames_missing,
              static_cast<std::uint64_t>(stream.parser.last_index() + 1));
  }
}

TEST(FrameParser, FramesWhoseRateStandsStillAreNotValid) {
  config::FrameDevice device = kvh_device();
  device.stuck_after = config::Seconds{3.0 / device.frame_rate_hz};
  Stream stream(device);
  const double rates[] = {1, 2, 2, 2, 2, 2, 2, 3, 4};
  for (std::int64_t i = 0; i < 9; ++i) stream.feed(kvh_frame(i, rates[i]));
  stream.settle();
  EXPECT_EQ(stream.block.index, (std::vector<std::int64_t>{0, 1, 2, 3, 4, 7, 8}));
  EXPECT_EQ(stream.statistics().frames_invalid, 2u);
  EXPECT_EQ(stream.statistics().frames_missing, 2u);
}

}  // namespace
}  // namespace fogbench::drivers
