#pragma once
// The only source of time. A SteadyClock is the machine's; a VirtualClock jumps to the next
// deadline at once, so that eight hours of bench time take seconds and every run repeats exactly.

#include <algorithm>
#include <chrono>
#include <functional>
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
  /// Advances as now() does, from the calendar as it was at the start or when it was last followed:
  /// whatever is done to the machine's calendar meanwhile, dates of one run never go back.
  virtual WallTime wall_now() const = 0;
  /// How far the machine's calendar has been set forward of wall_now() since then; negative: back.
  virtual Duration calendar_offset() const { return Duration::zero(); }
  /// Takes the machine's calendar over: between runs, never within one, on the thread that asks for
  /// wall_now().
  virtual void follow_calendar() {}
  /// Returns at once when the deadline has passed.
  virtual void sleep_until(Instant deadline) = 0;
  void sleep_for(Duration duration) { sleep_until(now() + duration); }
};

/// The machine's clock, its durations stretched by `speed` (2: a bench second takes half a second;
/// such a bench has a calendar of its own, which follows the machine's no more than at the start).
class SteadyClock final : public Clock {
 public:
  /// Reads the machine's calendar; any thread may call it.
  using Calendar = std::function<WallTime()>;
  explicit SteadyClock(double speed = 1.0, Calendar calendar = system_calendar);
  Instant now() const override;
  WallTime wall_now() const override;
  Duration calendar_offset() const override;
  void follow_calendar() override;
  void sleep_until(Instant deadline) override;
  static WallTime system_calendar();

 private:
  double speed_;
  Calendar calendar_;
  std::chrono::steady_clock::time_point started_;
  WallTime wall_at_zero_;  ///< the date of the instant 0
};

/// Starts at instant 0 and 2026-01-01T00:00:00Z unless told otherwise; moves only by sleeping.
class VirtualClock final : public Clock {
 public:
  VirtualClock();
  explicit VirtualClock(WallTime start);
  Instant now() const override { return now_; }
  WallTime wall_now() const override;
  Duration calendar_offset() const override { return offset_; }
  void follow_calendar() override;
  void sleep_until(Instant deadline) override;
  /// As a person or a time server sets the machine's calendar.
  void set_calendar(Duration forward) { offset_ += forward; }

 private:
  Instant now_{};
  WallTime start_;
  Duration offset_{};
};

/// ISO 8601 to the second: "2026-01-01T00:00:00Z".
std::string utc_text(Clock::WallTime time);
/// The same of Unix time in seconds.
std::string utc_text(double unix_s);

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
