// A gyro's serial line: noise, whole frames and damaged ones, in reads of any size.

#include <cmath>
#include <vector>

#include "drivers/crc.hpp"
#include "drivers/frame_parser.hpp"
#include "tests/fuzz/fuzz_input.hpp"
#include "tests/support/kvh_frame.hpp"

namespace fogbench::fuzz {
namespace {

/// A short little-endian frame with an 8-bit check and integers.
config::FrameDevice short_device() {
  config::FrameDevice device;
  device.name = "short";
  device.header = {0xA5, 0x5A};
  device.frame_bytes = 12;
  device.byte_order = config::ByteOrder::kLittleEndian;
  device.rate.offset_bytes = 4;
  device.rate.scale = 1e-4;
  device.status_offset_bytes = 3;
  device.status_valid_mask = 0x80;
  device.sequence_offset_bytes = 2;
  device.sequence_modulus = 256;
  device.crc = {.width_bits = 8, .polynomial = 7, .count_bytes = 11, .offset_bytes = 11};
  device.frame_rate_hz = 500.0;
  device.stuck_after = config::Seconds{0.05};
  return device;
}

class Line {
 public:
  explicit Line(const config::FrameDevice& device)
      : device_(device), crc_(device.crc), parser_(device) {}

  void feed(std::span<const std::uint8_t> bytes) {
    while (!bytes.empty()) {
      const auto space = parser_.space();
      require(!space.empty());
      const std::size_t count = std::min(space.size(), bytes.size());
      std::memcpy(space.data(), bytes.data(), count);
      parser_.parse(count, block_);
      bytes = bytes.subspan(count);
    }
  }
  std::vector<std::uint8_t> frame(Input& input) const {
    std::vector<std::uint8_t> bytes(device_.frame_bytes);
    std::copy(device_.header.begin(), device_.header.end(), bytes.begin());
    bytes[*device_.status_offset_bytes] = device_.status_valid_mask;
    bytes[device_.sequence_offset_bytes] = input.byte();
    const auto rate = input.bytes(4);
    std::copy(rate.begin(), rate.end(), bytes.begin() + device_.rate.offset_bytes);
    crc_.store(bytes.data());
    return bytes;
  }
  void settle(std::optional<drivers::Clock::Instant> empty_at) {
    parser_.settle(empty_at, block_);
    require(block_.rate_deg_per_h.size() == block_.index.size());
    require(block_.temperature_c.size() == (device_.temperature ? block_.index.size() : 0));
    for (std::size_t i = 0; i < block_.index.size(); ++i) {
      require(block_.index[i] > last_index_);
      require(std::isfinite(block_.rate_deg_per_h[i]));
      last_index_ = block_.index[i];
    }
    good_ += block_.index.size();
    require(parser_.statistics().frames_good == good_);
    block_.clear();
  }

 private:
  const config::FrameDevice device_;
  drivers::Crc crc_;
  drivers::FrameParser parser_;
  drivers::GyroBlock block_;
  std::int64_t last_index_ = -1;
  std::uint64_t good_ = 0;
};

}  // namespace
}  // namespace fogbench::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fogbench;  // NOLINT(google-build-using-namespace)
  fuzz::Input input(data, size);
  fuzz::Line line(input.byte() % 2 == 0 ? support::kvh_device() : fuzz::short_device());
  drivers::Clock::Instant now{};
  while (!input.empty()) {
    switch (input.byte() % 4) {
      case 0:
        line.feed(input.bytes(input.byte()));
        break;
      case 1:
        line.feed(line.frame(input));
        break;
      case 2: {
        auto frame = line.frame(input);
        frame[input.byte() % frame.size()] ^= static_cast<std::uint8_t>(1U << (input.byte() % 8));
        line.feed(frame);
        break;
      }
      default:
        now += std::chrono::milliseconds{input.number<std::uint16_t>()};
        line.settle(input.byte() % 2 == 0 ? std::optional(now) : std::nullopt);
    }
  }
  line.settle(now);
  return 0;
}
