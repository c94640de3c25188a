#include "drivers/frame_parser.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace fogbench::drivers {
namespace {

/// Large enough to spread the cost of a read, small enough for the second-level cache.
constexpr std::size_t kBufferBytes = std::size_t{64} * 1024;

/// Frames within stuck_after; chance repeats a rate once, hardly twice.
std::uint32_t repeats_within(const config::FrameDevice& device) {
  constexpr double kFewest = 2.0;
  constexpr double kMost = 4e9;
  if (!device.stuck_after) return std::numeric_limits<std::uint32_t>::max();
  const double frames = device.stuck_after->count() * device.frame_rate_hz;
  return static_cast<std::uint32_t>(std::clamp(frames, kFewest, kMost));
}

}  // namespace

Status check_layout(const config::FrameDevice& device) {
  const std::size_t size = device.frame_bytes;
  const auto outside = [&](std::string_view what, std::size_t first, std::size_t count) -> Status {
    if (first + count <= size) return {};
    return Error{ErrorCode::kBadInput,
                 fmt::format("{}: {} lies at bytes {} ... {} of a frame of {} bytes", device.name,
                             what, first, first + count - 1, size)};
  };
  const auto field = [&](const FieldSpec& spec) {
    return outside(spec.name, spec.offset_bytes, byte_count(spec.type));
  };
  if (device.header.empty() || device.header.size() > 8 || size < 8 || size > 4096) {
    return Error{
        ErrorCode::kBadInput,
        fmt::format("{}: header of {} bytes in a frame of {}, expected 1 ... 8 in 8 ... 4096",
                    device.name, device.header.size(), size)};
  }
  const std::size_t sequence_bytes = byte_count(device.sequence_type);
  const std::uint64_t most = std::uint64_t{1} << (8 * sequence_bytes);
  if (device.sequence_modulus < 2 || device.sequence_modulus > most) {
    return Error{ErrorCode::kBadInput, fmt::format("{}: sequence modulus {}, expected 2 ... {}",
                                                   device.name, device.sequence_modulus, most)};
  }
  if (!(device.frame_rate_hz > 0)) {
    return Error{ErrorCode::kBadInput, fmt::format("{}: frame rate {} Hz, expected more than 0",
                                                   device.name, device.frame_rate_hz)};
  }
  const config::CrcSpec& crc = device.crc;
  if (crc.width_bits != 8 && crc.width_bits != 16 && crc.width_bits != 32) {
    return Error{ErrorCode::kBadInput, fmt::format("{}: check of {} bits, expected 8, 16 or 32",
                                                   device.name, crc.width_bits)};
  }
  for (const Status& status :
       {field(device.rate), device.temperature ? field(*device.temperature) : Status{},
        device.status_offset_bytes ? outside("status", *device.status_offset_bytes, 1) : Status{},
        outside("sequence", device.sequence_offset_bytes, sequence_bytes),
        outside("checked part", crc.first_byte, crc.count_bytes),
        outside("check value", crc.offset_bytes, crc.width_bits / 8u)}) {
    if (!status) return status;
  }
  return {};
}

FrameParser::FrameParser(const config::FrameDevice& device)
    : crc_(device.crc),
      counter_(device.sequence_modulus, device.frame_rate_hz),
      frame_bytes_(device.frame_bytes),
      byte_order_(device.byte_order),
      rate_(device.rate),
      // Without a status no bit of any byte is asked for.
      status_offset_(device.status_offset_bytes.value_or(0)),
      status_mask_(device.status_offset_bytes ? device.status_valid_mask : 0),
      sequence_offset_(device.sequence_offset_bytes),
      sequence_bytes_(byte_count(device.sequence_type)),
      modulus_(device.sequence_modulus),
      most_repeats_(repeats_within(device)),
      buffer_(kBufferBytes) {
  assert(check_layout(device));
  std::memcpy(&header_, device.header.data(), device.header.size());
  std::memset(&header_mask_, 0xff, device.header.size());
  if (device.temperature) temperature_.emplace(*device.temperature);
}

std::span<std::byte> FrameParser::space() {
  return std::as_writable_bytes(std::span(buffer_).subspan(filled_));
}

const std::uint8_t* FrameParser::find_header(const std::uint8_t* place,
                                             const std::uint8_t* stop) const {
  const int first = static_cast<int>(header_ & 0xff);
  while (place < stop) {
    const void* found = std::memchr(place, first, static_cast<std::size_t>(stop - place));
    if (found == nullptr) return stop;
    place = static_cast<const std::uint8_t*>(found);
    if (has_header(place)) return place;
    ++place;
  }
  return stop;
}

void FrameParser::parse(std::size_t count, GyroBlock& block) {
  const std::uint8_t* place = buffer_.data();
  const std::uint8_t* const end = place + filled_ + count;
  const std::size_t before = block.index.size();
  const std::size_t most = before + (filled_ + count) / frame_bytes_;
  block.index.resize(most);
  block.rate_deg_per_h.resize(most);
  if (temperature_) block.temperature_c.resize(most);

  std::size_t size = before;
  while (static_cast<std::size_t>(end - place) >= frame_bytes_) {
    const bool headed = has_header(place);
    if (!headed || !crc_.holds(place)) {
      if (headed) ++statistics_.frames_bad_checksum;
      const std::uint8_t* next = find_header(place + 1, end - frame_bytes_ + 1);
      unframed_bytes_ += static_cast<std::size_t>(next - place);
      statistics_.bytes_skipped += static_cast<std::uint64_t>(next - place);
      place = next;
      continue;
    }
    const std::uint8_t* const frame = place;
    place += frame_bytes_;
    // Half a frame more or less still counts as the right number of frames.
    const std::size_t periods_skipped =
        unframed_bytes_ == 0 ? 0 : (unframed_bytes_ + frame_bytes_ / 2) / frame_bytes_;
    unframed_bytes_ = 0;
    const std::uint32_t sequence =
        load_bytes(frame + sequence_offset_, sequence_bytes_, byte_order_);
    if (sequence >= modulus_) {
      ++statistics_.frames_invalid;
      continue;
    }
    const std::int64_t index = counter_.advance(
        sequence, static_cast<std::int64_t>(periods_skipped), entries_ + size - before);
    const auto rate = static_cast<float>(rate_.read(frame, byte_order_));
    rate_repeats_ = rate == last_rate_ ? rate_repeats_ + 1 : 0;
    last_rate_ = rate;
    if ((frame[status_offset_] & status_mask_) != status_mask_ || !std::isfinite(rate) ||
        stands_still()) {
      ++statistics_.frames_invalid;
      continue;
    }
    block.index[size] = index;
    block.rate_deg_per_h[size] = rate;
    if (temperature_) {
      block.temperature_c[size] = static_cast<float>(temperature_->read(frame, byte_order_));
    }
    ++size;
  }
  block.index.resize(size);
  block.rate_deg_per_h.resize(size);
  if (temperature_) block.temperature_c.resize(size);
  entries_ += size - before;
  filled_ = static_cast<std::size_t>(end - place);
  std::memmove(buffer_.data(), place, filled_);
}

void FrameParser::settle(std::optional<Clock::Instant> empty_at, GyroBlock& block) {
  counter_.settle(empty_at, periods_since(), entries_, block, statistics_);
  entries_ = 0;
}

}  // namespace fogbench::drivers
