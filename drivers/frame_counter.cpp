#include "drivers/frame_counter.hpp"

#include <algorithm>

namespace fogbench::drivers {
namespace {

/// Each read moves the phase this part of the way: read jitter is averaged, while an oscillator
/// 100 ppm off, at 1 kHz and one read a second, lags 1.6 periods behind.
constexpr double kPhaseGain = 1.0 / 16.0;

/// Keeps the entries from `first` on whose index exceeds all before; returns how many it took out.
std::size_t remove_repeats(std::size_t first, std::int64_t highest, GyroBlock& block) {
  std::size_t kept = first;
  for (std::size_t i = first; i < block.index.size(); ++i) {
    if (block.index[i] <= highest) continue;
    highest = block.index[i];
    block.index[kept] = block.index[i];
    block.rate_deg_per_h[kept] = block.rate_deg_per_h[i];
    if (!block.temperature_c.empty()) block.temperature_c[kept] = block.temperature_c[i];
    ++kept;
  }
  const std::size_t removed = block.index.size() - kept;
  block.index.resize(kept);
  block.rate_deg_per_h.resize(kept);
  if (!block.temperature_c.empty()) block.temperature_c.resize(kept);
  return removed;
}

}  // namespace

void FrameCounter::settle(std::optional<Clock::Instant> empty_at, std::int64_t periods_since,
                          std::size_t entries, GyroBlock& block, StreamStatistics& statistics) {
  if (last_sequence_ < 0) return;
  const std::size_t first = block.index.size() - entries;
  const std::int64_t turns = empty_at ? missing_turns(*empty_at, periods_since) : 0;
  if (turns != 0) {
    for (std::size_t i = first + jump_entry_; i < block.index.size(); ++i) {
      block.index[i] += turns * modulus_;
    }
    last_index_ += turns * modulus_;
    put_in_ += turns * modulus_;
  }
  std::size_t repeated = 0;
  const bool goes_back = entries > 0 && block.index[first] <= settled_index_;
  if (has_repeats_ || goes_back || turns < 0) {
    repeated = remove_repeats(first, settled_index_, block);
  }

  settled_index_ = std::max(settled_index_, last_index_);
  if (repeated < entries) settled_index_ = std::max(settled_index_, block.index.back());
  statistics.frames_repeated += repeated;
  statistics.frames_good += entries - repeated;
  statistics.frames_missing =
      static_cast<std::uint64_t>(settled_index_ + 1) - statistics.frames_good;
  has_new_ = false;
  has_repeats_ = false;
  jump_ = 0;
  jump_entry_ = 0;
  late_ = std::numeric_limits<double>::infinity();
}

double FrameCounter::least_late(Clock::Instant empty_at, std::int64_t periods_since) {
  const auto counted = static_cast<double>(last_index_ + periods_since);
  if (!origin_) {
    origin_ = empty_at;
    phase_ = -counted;
  }
  const double late = to_seconds(empty_at - *origin_) * frame_rate_hz_ - counted - phase_;
  return late_ = std::min(late_, late);
}

bool FrameCounter::misses_turns(Clock::Instant empty_at, std::int64_t periods_since) {
  return last_sequence_ >= 0 && turns_in(least_late(empty_at, periods_since)) > 0 && lost_before();
}

std::int64_t FrameCounter::missing_turns(Clock::Instant empty_at, std::int64_t periods_since) {
  const double late = least_late(empty_at, periods_since);
  std::int64_t turns = turns_in(late);
  silent_ = turns > 0 && !lost_before();
  if (silent_ || (turns < 0 && jump_ == 0)) turns = 0;

  // A frame never arrives before it was measured, so a smaller phase is the truer one.
  const double rest = late - static_cast<double>(turns * modulus_);
  if (rest < 0) {
    phase_ += rest;
  } else if (!silent_) {
    phase_ += kPhaseGain * rest;
  }
  return turns;
}

}  // namespace fogbench::drivers
