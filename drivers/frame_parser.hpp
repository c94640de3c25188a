#pragma once
// From the bytes of a gyro's serial stream to its good frames. Bytes are read straight into the
// parser's buffer and decoded in place:
//
//   while (bytes come)  parser.parse(serial.read_some(parser.space()), block);
//   parser.settle(clock.now(), block);
//
// A frame is good when header, check value and status are and its rate does not stand still; a
// place that looks like a header but whose check value fails is left by one byte, so that a frame
// that begins inside it is found.

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "config/device.hpp"
#include "drivers/clock.hpp"
#include "drivers/crc.hpp"
#include "drivers/frame_counter.hpp"
#include "drivers/instruments.hpp"
#include "drivers/number_codec.hpp"

namespace fogbench::drivers {

/// kBadInput when a field, the status, the sequence or the check lies outside the frame, when the
/// header is not 1 to 8 bytes, or the sequence does not fit its bytes.
Status check_layout(const config::FrameDevice& device);

class FrameParser {
 public:
  /// Precondition: check_layout(device).
  explicit FrameParser(const config::FrameDevice& device);

  /// Where the next bytes go; never empty. Valid until parse().
  std::span<std::byte> space();
  /// Takes `count` bytes out of space() and appends their good frames to `block`, with provisional
  /// indexes.
  void parse(std::size_t count, GyroBlock& block);
  /// Whether frames seem to be lost that may only be late (see FrameCounter). `empty_at`: when the
  /// line was found empty.
  bool misses_turns(Clock::Instant empty_at) {
    return counter_.misses_turns(empty_at, periods_since());
  }
  /// Makes the indexes of all entries since the last call final (see FrameCounter).
  /// `empty_at`: the moment at which the line was found empty; none when it was not.
  /// Precondition: those entries are still the last ones of `block`.
  void settle(std::optional<Clock::Instant> empty_at, GyroBlock& block);

  /// Good, repeated and missing frames are counted by settle(), the others by parse().
  const StreamStatistics& statistics() const { return statistics_; }
  /// Whether the rate has stood still to the last bit for longer than it may.
  bool stands_still() const { return rate_repeats_ > most_repeats_; }
  /// Of the newest frame; -1 before the first.
  std::int64_t last_index() const { return counter_.last_index(); }
  /// Likewise, by the sequence numbers alone.
  std::int64_t counted() const { return counter_.counted(); }

 private:
  struct Field {
    explicit Field(const FieldSpec& spec)
        : offset(spec.offset_bytes),
          bytes(byte_count(spec.type)),
          type(spec.type),
          scale(spec.scale),
          shift(spec.offset) {}
    double read(const std::uint8_t* frame, ByteOrder order) const {
      return raw_from_bits(type, load_bytes(frame + offset, bytes, order)) * scale + shift;
    }
    std::size_t offset;
    std::size_t bytes;
    NumberType type;
    double scale;
    double shift;
  };

  bool has_header(const std::uint8_t* place) const {
    std::uint64_t word = 0;
    std::memcpy(&word, place, sizeof word);
    return (word & header_mask_) == header_;
  }
  /// Frames' worth of bytes that have come after the last frame.
  std::int64_t periods_since() const {
    return static_cast<std::int64_t>((unframed_bytes_ + filled_) / frame_bytes_);
  }
  /// The first place in [place, stop) where a header stands; stop when there is none.
  const std::uint8_t* find_header(const std::uint8_t* place, const std::uint8_t* stop) const;

  Crc crc_;
  FrameCounter counter_;
  std::size_t frame_bytes_;
  std::uint64_t header_ = 0;  ///< as the frame's first bytes load into a word
  std::uint64_t header_mask_ = 0;
  ByteOrder byte_order_;
  Field rate_;
  std::optional<Field> temperature_;
  std::size_t status_offset_;
  std::uint8_t status_mask_;
  std::size_t sequence_offset_, sequence_bytes_;
  std::uint64_t modulus_;
  std::uint32_t most_repeats_;  ///< of the rate in frames one after the other

  float last_rate_ = std::numeric_limits<float>::quiet_NaN();
  std::uint32_t rate_repeats_ = 0;
  std::vector<std::uint8_t> buffer_;
  std::size_t filled_ = 0;          ///< bytes at the start of the buffer that wait for more
  std::size_t unframed_bytes_ = 0;  ///< thrown away since the last frame whose check value held
  std::size_t entries_ = 0;         ///< appended since the last settle()
  StreamStatistics statistics_;
};

}  // namespace fogbench::drivers
