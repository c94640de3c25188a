#include "procedures/sentence.hpp"

#include <fmt/format.h>

#include <cmath>

#include "procedures/planned_points.hpp"

namespace fogbench::procedures {
namespace {

std::string as(const std::string& segment) {
  return segment.empty() ? "" : " as " + segment;
}

std::string recording(const std::string& segment, Seconds window) {
  if (segment.empty()) return "";
  return fmt::format(", recording averages of {} as {}", duration_text(window), segment);
}

std::string say(const SetTemperature& s) {
  switch (s.mode) {
    case HeatingMode::kOff:
      return "switch the heaters off";
    case HeatingMode::kBoost:
      return fmt::format("heat to {} degC with the boost heaters", s.target.value);
    case HeatingMode::kNormal:
      return fmt::format("hold {} degC in normal mode", s.target.value);
  }
  return {};
}
std::string say(const Ramp& s) {
  return fmt::format("ramp to {} degC at {} degC/h{}{}", s.to.value, s.rate.value,
                     s.mode == HeatingMode::kNormal ? " in normal mode" : "",
                     recording(s.segment, s.window));
}
std::string say(const SettleTemperature& s) {
  if (s.dwell.count() <= 0) {
    return fmt::format("wait until the temperature is within {} degC of its target (at most {}){}",
                       s.band.value, duration_text(s.timeout), recording(s.segment, s.window));
  }
  return fmt::format(
      "wait until the temperature stays within {} degC of its target for {}, changing by less "
      "than {} degC/h (at most {}){}",
      s.band.value, duration_text(s.dwell), s.slope_c_per_h, duration_text(s.timeout),
      recording(s.segment, s.window));
}
std::string say(const Wait& s) {
  const std::string tail = recording(s.segment, s.window);
  if (s.operating_time.count() <= 0) {
    const std::size_t points = windows_in(s.duration, s.window);
    return fmt::format("wait for {}{}{}", duration_text(s.duration), tail,
                       tail.empty()  ? ""
                       : points == 1 ? ": 1 point"
                                     : fmt::format(": {} points", points));
  }
  const std::string until =
      fmt::format("wait until {} of operation", duration_text(s.operating_time));
  if (s.duration.count() <= 0) return until + tail;
  return fmt::format("{}, and at least {}{}", until, duration_text(s.duration), tail);
}
std::string say(const Average& s) {
  return (s.baseline ? "measure the baseline for " : "average for ") + duration_text(s.duration) +
         as(s.segment);
}
std::string say(const CompensateField& s) {
  return fmt::format("null the ambient field along both coil axes to within {} uT",
                     s.tolerance.value);
}
std::string say(const SweepLevel& s) {
  return fmt::format("set {} uT {}{}, settle for {}, average for {}{}", s.level.value,
                     along_text(s.axis), across_text(s), duration_text(s.settle),
                     duration_text(s.duration), as(s.segment));
}
std::string say(const Rotate& s) {
  return fmt::format("turn the gyro to azimuth {} deg, coils at 0 A", s.azimuth.value);
}
std::string say(const Prompt& s) {
  return "ask the operator: " + s.text;
}

}  // namespace

std::string sentence(const PlannedStep& step) {
  return std::visit([](const auto& action) { return say(action); }, step.action);
}

std::string along_text(Axis axis) {
  constexpr const char* kAlong[] = {"along OX", "along OY", "along OZ", "along north"};
  return kAlong[static_cast<int>(axis)];
}

std::string across_text(const SweepLevel& level) {
  if (level.other_pair.value == 0.0) return {};
  return fmt::format(" and {} uT {}", level.other_pair.value,
                     level.axis == Axis::kX ? "north" : "along OX");
}

std::string duration_text(Seconds duration) {
  const double seconds = duration.count();
  constexpr double kLongest = 1e12;  // more makes no sense in hours, and no integer beyond some
  if (!(seconds >= 60.0 && seconds <= kLongest)) return fmt::format("{} s", seconds);
  const auto whole = static_cast<long long>(std::llround(seconds));
  const auto h = whole / 3600, min = whole / 60 % 60, s = whole % 60;
  std::string text;
  if (h != 0) text = fmt::format("{} h", h);
  if (min != 0) text += fmt::format("{}{} min", text.empty() ? "" : " ", min);
  if (s != 0) text += fmt::format("{}{} s", text.empty() ? "" : " ", s);
  return text;
}

}  // namespace fogbench::procedures
