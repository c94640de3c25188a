#pragma once
// The only source of time. A SteadyClock is the machine's; a VirtualClock jumps to the next
// deadline at once, so that eight hours of bench time take seconds and every run repeats exactly.

#include <algorithm>
#include <chrono>
#include <string>

namespace fogbench::drivers {

class Clock {
 public:
  using Duration = std::chrono::nanoseconds;
  /// Steady: never set back, unrelated to the calendar.
  using Instant = std::chrono::time_point<Clock, Duration>;
  /// UTC, for time stamps that a person reads; never for a duration.
  using WallTime = std::chrono::sys_time<std::chrono::milliseconds>;

  Clock() = default;
  Clock(const Clock&) = delete;
  Clock& operator=(const Clock&) = delete;
  virtual ~Clock() = default;

  virtual Instant now() const = 0;
  virtual WallTime wall_now() const = 0;
  /// Returns at once when the deadline has passed.
  virtual void sleep_until(Instant deadline) = 0;
  void sleep_for(Duration duration) { sleep_until(now() + duration); }
};

/// The machine's clock, its durations stretched by `speed` (2: a bench second takes half a second).
class SteadyClock final : public Clock {
 public:
  explicit SteadyClock(double speed = 1.0);
  Instant now() const override;
  WallTime wall_now() const override;
  void sleep_until(Instant deadline) override;

 private:
  double speed_;
  std::chrono::steady_clock::time_point started_;
  WallTime wall_started_;
};

/// Starts at instant 0 and 2026-01-01T00:00:00Z unless told otherwise; moves only by sleeping.
class VirtualClock final : public Clock {
 public:
  VirtualClock();
  explicit VirtualClock(WallTime start);
  Instant now() const override { return now_; }
  WallTime wall_now() const override;
  void sleep_until(Instant deadline) override;

 private:
  Instant now_{};
  WallTime start_;
};

/// ISO 8601 to the second: "2026-01-01T00:00:00Z".
std::string utc_text(Clock::WallTime time);

/// Such a text as seconds since 1970, UTC; NaN for any other.
double seconds_of_utc(const std::string& text);

/// Seconds as a double, for results and tables.
constexpr double to_seconds(Clock::Duration d) {
  return std::chrono::duration<double>(d).count();
}
/// Rounded to the nanosecond, and held within 30 years: sums of a few stay in range, whatever a
/// file says. NaN is 0.
constexpr Clock::Duration from_seconds(double s) {
  constexpr double kLongest = 1e9;
  s = s != s ? 0.0 : std::clamp(s, -kLongest, kLongest);
  return Clock::Duration{static_cast<Clock::Duration::rep>(s * 1e9 + (s < 0 ? -0.5 : 0.5))};
}

}  // namespace fogbench::drivers
