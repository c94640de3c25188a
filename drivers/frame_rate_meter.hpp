#pragma once
// Holds the frame rate that a gyro's description states against the clock. The times of a record
// come from the gyro's counter and that rate, so a wrong rate falsifies all of them.
//
// Seen at a look, frame n is late by  now - n / stated rate,  give or take a constant. A rate that
// is as stated leaves the lateness where it is, another one makes it grow or shrink. What disturbs
// it:
//
//   a busy machine, an adapter   late frames only look later: of each span the least late one
//   counts lost frames                  are counted by their sequence numbers and change nothing
//   lost turns of the sequence,  shift the lateness for good, but between two spans only: of seven
//   repeated frames, a stall     changes from span to span six must agree, within half of their
//                                median; chance lateness of whatever size does so once in 10,000
//
// A span is a second, and longer where looks at new frames are rarer than twenty a second.

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include "drivers/clock.hpp"
#include "drivers/instruments.hpp"

namespace fogbench::drivers {

class FrameRateMeter {
 public:
  /// Far above any oscillator (1e-4), below what the index is kept by (FrameCounter: half a turn of
  /// 128 lags behind beyond 0.4 % at one read a second).
  static constexpr double kTolerance = 0.003;
  static constexpr Clock::Duration kSpan = std::chrono::seconds{1};
  static constexpr int kLooks = 20;

  explicit FrameRateMeter(double stated_hz) : stated_hz_(stated_hz) {}

  /// All frames that have come by `now` have been taken; `counted` of them by their sequence
  /// numbers, lost ones too.
  void look(Clock::Instant now, std::int64_t counted);
  /// Over the last eight spans; nothing before, nor while they neither agree nor contradict.
  std::optional<FrameRate> rate() const;

 private:
  struct Span {
    Clock::Instant since{};
    double least_late_s = std::numeric_limits<double>::infinity();
  };
  static constexpr std::size_t kSpans = 8;

  double stated_hz_;
  std::optional<Clock::Instant> origin_;
  std::int64_t counted_ = 0;          ///< at the last look
  Span span_;                         ///< the present one
  int looks_ = 0;                     ///< in it, at new frames
  std::array<Span, kSpans> spans_{};  ///< complete ones, the oldest first
  std::size_t complete_ = 0;
};

}  // namespace fogbench::drivers
