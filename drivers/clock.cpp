#include "drivers/clock.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <thread>
#include <utility>

namespace fogbench::drivers {

SteadyClock::SteadyClock(double speed, Calendar calendar)
    : speed_(speed),
      calendar_(std::move(calendar)),
      started_(std::chrono::steady_clock::now()),
      wall_at_zero_(calendar_()) {}

Clock::WallTime SteadyClock::system_calendar() {
  return std::chrono::floor<std::chrono::milliseconds>(std::chrono::system_clock::now());
}

Clock::Instant SteadyClock::now() const {
  const std::chrono::duration<double, std::nano> real = std::chrono::steady_clock::now() - started_;
  return Instant{Duration{static_cast<Duration::rep>(real.count() * speed_)}};
}

Clock::WallTime SteadyClock::wall_now() const {
  return wall_at_zero_ + std::chrono::floor<std::chrono::milliseconds>(now().time_since_epoch());
}

Clock::Duration SteadyClock::calendar_offset() const {
  if (speed_ != 1.0) return Duration::zero();
  // Both at one moment: whoever was held up in between looks again.
  constexpr std::chrono::milliseconds kOneMoment{100};
  for (;;) {
    const WallTime before = wall_now();
    const WallTime calendar = calendar_();
    if (wall_now() - before < kOneMoment) return calendar - before;
  }
}

void SteadyClock::follow_calendar() {
  if (speed_ != 1.0) return;  // it has one of its own
  wall_at_zero_ += std::chrono::floor<std::chrono::milliseconds>(calendar_offset());
}

void SteadyClock::sleep_until(Instant deadline) {
  const std::chrono::duration<double, std::nano> real{
      static_cast<double>(deadline.time_since_epoch().count()) / speed_};
  std::this_thread::sleep_until(
      started_ + std::chrono::duration_cast<std::chrono::steady_clock::duration>(real));
}

std::string utc_text(Clock::WallTime time) {
  // fmt 9 takes a time_point itself to be local time.
  return fmt::format("{:%FT%TZ}", fmt::gmtime(std::chrono::floor<std::chrono::seconds>(time)));
}

std::string utc_text(double unix_s) {
  return utc_text(Clock::WallTime{
      std::chrono::floor<Clock::WallTime::duration>(std::chrono::duration<double>(unix_s))});
}

double seconds_of_utc(const std::string& text) {
  int year = 0;
  unsigned month = 0, day = 0, hour = 0, minute = 0, second = 0;
  char zone = 0;
  const int read = std::sscanf(text.c_str(), "%4d-%2u-%2uT%2u:%2u:%2u%c", &year, &month, &day,
                               &hour, &minute, &second, &zone);
  const std::chrono::year_month_day date{std::chrono::year{year}, std::chrono::month{month},
                                         std::chrono::day{day}};
  if (read != 7 || zone != 'Z' || !date.ok()) return std::nan("");
  const std::chrono::seconds day_start = std::chrono::sys_days{date}.time_since_epoch();
  return static_cast<double>(day_start.count()) + 3600.0 * hour + 60.0 * minute + second;
}

VirtualClock::VirtualClock()
    : VirtualClock(std::chrono::sys_days{std::chrono::year{2026} / std::chrono::January / 1}) {}

VirtualClock::VirtualClock(WallTime start) : start_(start) {}

Clock::WallTime VirtualClock::wall_now() const {
  return start_ + std::chrono::floor<std::chrono::milliseconds>(now_.time_since_epoch());
}

void VirtualClock::follow_calendar() {
  start_ += std::chrono::floor<std::chrono::milliseconds>(offset_);
  offset_ = Duration::zero();
}

void VirtualClock::sleep_until(Instant deadline) {
  if (deadline > now_) now_ = deadline;
}

}  // namespace fogbench::drivers
