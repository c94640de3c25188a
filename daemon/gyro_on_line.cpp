#include "daemon/gyro_on_line.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "procedures/sentence.hpp"

namespace fogbench::daemon {
namespace {

using drivers::Clock;

std::string span(double seconds) {
  return procedures::duration_text(config::Seconds{std::round(seconds)});
}

}  // namespace

std::string GyroOnLine::at(Clock::Instant instant) const {
  const double ago_s = drivers::to_seconds(clock_.now() - instant);
  const std::chrono::duration<double> now = clock_.wall_now().time_since_epoch();
  return drivers::utc_text(now.count() - ago_s);
}

std::string GyroOnLine::listen() {
  frames_.clear();
  // Whatever it says of a silence, that is heard here.
  (void)gyro_.read(frames_);
  const Clock::Instant now = clock_.now();
  if (frames_.index.empty()) {
    const auto longest = std::max<Clock::Duration>(
        kSilence, drivers::from_seconds(kSilencePeriods / gyro_.frame_rate_hz()));
    if (silent_ || now - heard_ < longest) return {};
    silent_ = true;
    return "gyro: silent, as one that is switched off";
  }
  const Clock::Instant before = heard_;
  heard_ = now;
  if (!silent_) return {};
  silent_ = false;
  silence_ = Silence{now, drivers::to_seconds(now - before)};
  return fmt::format("gyro: heard again after {}", span(silence_->lasted_s));
}

Result<GyroOnLine::Taken> GyroOnLine::take(const std::string& gyro,
                                           const std::optional<SwitchedOn>& said, bool exchanged) {
  Taken taken;
  taken.before = serial_number_;
  const bool other = !serial_number_.empty() && !gyro.empty() && gyro != serial_number_;
  if (!gyro.empty()) serial_number_ = gyro;
  const std::string name = gyro.empty() ? "the gyro" : "gyro " + gyro;
  std::optional<Clock::Instant> since;
  std::string because;
  if (said) {
    const std::chrono::duration<double> now = clock_.wall_now().time_since_epoch();
    since = clock_.now() - drivers::from_seconds(now.count() - said->unix_s);
    because = "as " + said->by + " says";
  } else if (exchanged) {
    since = clock_.now();
    because = "put on and switched on for this run";
  } else if (silence_) {
    since = silence_->ended;
    because = fmt::format("when its stream came after a silence of {}", span(silence_->lasted_s));
  } else if (other) {
    since = clock_.now();
    because = "the begin of its run, since the stream has not told when it was switched on";
    taken.doubtful = true;
  }
  silence_.reset();
  if (since) {
    if (Status begun = gyro_.begin_anew(*since); !begun) return begun.error();
    taken.remarks.push_back(
        fmt::format("operating time of {} counts from {}, {}", name, at(*since), because));
  }
  heard();
  return taken;
}

}  // namespace fogbench::daemon
