#pragma once
// From the sequence numbers of a stream, which wrap, to an index that does not: the number of frame
// periods since the first frame. Neighbouring frames are told apart by the sequence number; how
// many whole turns of it were lost in a silence, only the clock can say.
//
// Between two moments at which the line was found empty, indexes are provisional: the smallest step
// forward that the sequence number and the bytes thrown away in between allow. Then the clock is
// asked how many periods have passed:
//
//   missing turns k = round((periods by the clock - periods counted) / modulus)
//
//   k > 0  whole turns were lost. The gap is put at the largest jump or, when there is none, before
//          the first frame that came after a silence. When there is neither, the line has just
//          fallen silent: nothing is missing yet, and the next frames will tell.
//   k < 0  frames came again that had been received before, and their first looked like a jump.
//
// Frames that a busy machine brings late look just like lost turns, but only for a moment. So
// before turns are put in, misses_turns() is asked again and again while the line is read on: what
// counts is the least that was missing meanwhile.
//
// The clock is only asked for the nearest whole turn, so its jitter and the instrument's own
// oscillator do not matter as long as they stay below half a turn (64 periods of 128).

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "drivers/clock.hpp"
#include "drivers/instruments.hpp"

namespace fogbench::drivers {

class FrameCounter {
 public:
  FrameCounter(std::uint64_t modulus, double frame_rate_hz)
      : modulus_(static_cast<std::int64_t>(modulus)), frame_rate_hz_(frame_rate_hz) {}

  /// The provisional index of a frame with this sequence number, which must be below the modulus.
  /// `periods_skipped`: how many frames' worth of bytes were thrown away just before it.
  /// `entry`: how many entries the block has had since the last settle().
  std::int64_t advance(std::uint32_t sequence, std::int64_t periods_skipped, std::size_t entry) {
    if (last_sequence_ < 0) {
      has_new_ = true;
      last_sequence_ = sequence;
      return last_index_ = 0;
    }
    std::int64_t step = sequence - last_sequence_;
    if (step < 0) step += modulus_;
    if (periods_skipped > 0) {
      // The turn that agrees best with the bytes that came in between.
      const std::int64_t more = periods_skipped + 1 - step + modulus_ / 2;
      if (more > 0) step += more / modulus_ * modulus_;
    }
    (step == 0 ? has_repeats_ : has_new_) = true;
    if (step - 1 - periods_skipped > jump_) {
      jump_ = step - 1 - periods_skipped;
      jump_entry_ = entry;
    }
    last_sequence_ = sequence;
    return last_index_ += step;
  }

  /// Whether settle() would put lost turns in, from this moment and all at which it was asked since
  /// the last settle(). `empty_at`, `periods_since`: as there.
  bool misses_turns(Clock::Instant empty_at, std::int64_t periods_since);

  /// Makes the last `entries` entries of `block` final: puts lost turns where they belong, takes
  /// repeated frames out and counts them. `empty_at`: when the line was found empty, if it was.
  /// `periods_since`: how many frames' worth of bytes have come after the last frame.
  void settle(std::optional<Clock::Instant> empty_at, std::int64_t periods_since,
              std::size_t entries, GyroBlock& block, StreamStatistics& statistics);

  /// Of the newest frame; -1 before the first.
  std::int64_t last_index() const { return last_index_; }
  /// The same by the sequence numbers alone, without the turns that the clock has put in: what the
  /// clock may be held against.
  std::int64_t counted() const { return last_index_ - put_in_; }

 private:
  /// Whole turns to put in now; follows the phase.
  std::int64_t missing_turns(Clock::Instant empty_at, std::int64_t periods_since);
  /// Periods by the clock beyond those counted: the least since the last settle().
  double least_late(Clock::Instant empty_at, std::int64_t periods_since);
  std::int64_t turns_in(double periods) const {
    return std::llround(periods / static_cast<double>(modulus_));
  }
  /// New frames have come, and there is a place where turns can have been lost before them.
  bool lost_before() const { return has_new_ && (silent_ || jump_ > 0); }

  std::int64_t modulus_;
  double frame_rate_hz_;
  std::int64_t last_sequence_ = -1;
  std::int64_t last_index_ = -1;
  std::int64_t settled_index_ = -1;  ///< the highest at the last settle()
  std::int64_t put_in_ = 0;          ///< frames in the turns that the clock has put in

  // Since the last settle().
  bool has_new_ = false;  ///< frames that were no repeats
  bool has_repeats_ = false;
  std::int64_t jump_ = 0;  ///< the largest number of frames missing at once without a trace
  std::size_t jump_entry_ = 0;
  double late_ = std::numeric_limits<double>::infinity();  ///< the least, in periods

  std::optional<Clock::Instant> origin_;
  double phase_ = 0.0;   ///< periods by the clock since origin_, minus index: follows slow drift
  bool silent_ = false;  ///< the line had been silent for more than half a turn
};

}  // namespace fogbench::drivers
