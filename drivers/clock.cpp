#include "drivers/clock.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <thread>

namespace fogbench::drivers {

SteadyClock::SteadyClock(double speed)
    : speed_(speed),
      started_(std::chrono::steady_clock::now()),
      wall_started_(
          std::chrono::floor<std::chrono::milliseconds>(std::chrono::system_clock::now())) {}

Clock::Instant SteadyClock::now() const {
  const std::chrono::duration<double, std::nano> real = std::chrono::steady_clock::now() - started_;
  return Instant{Duration{static_cast<Duration::rep>(real.count() * speed_)}};
}

Clock::WallTime SteadyClock::wall_now() const {
  return wall_started_ + std::chrono::floor<std::chrono::milliseconds>(now().time_since_epoch());
}

void SteadyClock::sleep_until(Instant deadline) {
  const std::chrono::duration<double, std::nano> real{
      static_cast<double>(deadline.time_since_epoch().count()) / speed_};
  std::this_thread::sleep_until(
      started_ + std::chrono::duration_cast<std::chrono::steady_clock::duration>(real));
}

std::string utc_text(Clock::WallTime time) {
  return fmt::format("{:%FT%TZ}", std::chrono::floor<std::chrono::seconds>(time));
}

VirtualClock::VirtualClock()
    : VirtualClock(std::chrono::sys_days{std::chrono::year{2026} / std::chrono::January / 1}) {}

VirtualClock::VirtualClock(WallTime start) : start_(start) {}

Clock::WallTime VirtualClock::wall_now() const {
  return start_ + std::chrono::floor<std::chrono::milliseconds>(now_.time_since_epoch());
}

void VirtualClock::sleep_until(Instant deadline) {
  if (deadline > now_) now_ = deadline;
}

}  // namespace fogbench::drivers
