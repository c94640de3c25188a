#include "config/interlock.hpp"

#include <algorithm>
#include <array>

#include "config/bench.hpp"
#include "config/channels.hpp"
#include "config/describe_interlock.hpp"

namespace fogbench::config {
namespace {

using Kind = InterlockKind;

/// A threshold that may be negative, far from anything that is meant.
constexpr double kAnyThreshold = -100000.0;

/// Full power heats by 0.15 degC meanwhile.
constexpr std::uint16_t kSlowestGuard = 10;

constexpr std::array<InterlockKindInfo, 10> kKinds = {
    {{Kind::kOverTemperature, "over_temperature", "trip_c", "clear_c", kAnyThreshold, "degC",
      "temperature is", "The hottest of the three sensors on the carrier is above this."},
     {Kind::kSensorDisagreement, "sensor_disagreement", "trip_c", "clear_c", 0.0, "degC",
      "from the control sensor by", "A working sensor is farther than this from the control one."},
     {Kind::kHeaterWithoutEffect, "heater_without_effect", "trip_s", "clear_s", 0.0, "s",
      "heated without getting warmer for",
      "The thermostat has been heating for longer than this without getting warmer by rise_c."},
     {Kind::kFieldMismatch, "field_mismatch", "trip_ut", "clear_ut", 0.0, "uT",
      "field differs from the commanded one by",
      "The measured field along up or north is farther than this from the commanded one."},
     {Kind::kCurrentMismatch, "current_mismatch", "trip_a", "clear_a", 0.0, "A",
      "current differs from the commanded one by",
      "A supply's measured current is farther than this from the commanded one."},
     {Kind::kGyroSilent, "gyro_silent", "trip_s", "clear_s", 0.0, "s", "no good frame for",
      "No good frame has come from the gyro for longer than this."},
     {Kind::kGyroInvalid, "gyro_invalid", "trip_percent", "clear_percent", 0.0, "%",
      "frames of the last second whose status is not valid:",
      "More than this part of the last second's frames have a status that is not valid."},
     {Kind::kCalibrationOverdue, "calibration_overdue", "trip_days", "clear_days", kAnyThreshold,
      "days", "calibration is overdue by",
      "An instrument's calibration_due is more than this many days ago; negative: ahead."},
     {Kind::kChannelAbove, "channel_above", "trip", "clear", kAnyThreshold, "", "reads",
      "The channel's value, in the unit that its name ends in, is above this."},
     {Kind::kChannelBelow, "channel_below", "trip", "clear", kAnyThreshold, "", "reads",
      "The channel's value, in the unit that its name ends in, is below this."}}};

InterlockConfig one(InterlockKind kind, double trip, double clear, std::uint16_t consecutive,
                    InterlockAction action) {
  return {std::string(info_of(kind).name), {{kind, trip, clear}}, {}, consecutive, action};
}

}  // namespace

std::span<const InterlockKindInfo> interlock_kinds() {
  return kKinds;
}

const InterlockKindInfo& info_of(InterlockKind kind) {
  return kKinds[static_cast<std::size_t>(kind)];
}

std::string_view unit_of(const InterlockCondition& condition) {
  return watches_channel(condition.kind) ? unit_of(condition.channel)
                                         : info_of(condition.kind).unit;
}

std::string_view name_of(InterlockAction action) {
  for (const auto& [name, value] : enum_names(action)) {
    if (value == action) return name;
  }
  return {};
}

// Thresholds. Temperature: the limit and the overshoot. Sensors: boost heating drives the working
// sensors 0.3 degC from the control one, offsets are as large again. Heater: full power raises
// temperature by at least 4 degC/h down to the last 2 degC, so 0.5 degC take 450 s at most. Field:
// 1 % of 300 uT, an axis 1 deg off (5 uT), a lift. Current: a hundred times the read-back's noise.
std::vector<InterlockConfig> default_interlocks(const BenchConfig& bench) {
  const double highest_c = bench.limits.temperature_maximum.value;
  const double silence_s = std::max(5.0, 20.0 / bench.gyro.device.frame_rate_hz);
  using Action = InterlockAction;
  return {one(Kind::kOverTemperature, highest_c + kOvershoot.value, highest_c, 3, Action::kAbort),
          one(Kind::kSensorDisagreement, 1.0, 0.8, 10, Action::kWarn),
          one(Kind::kHeaterWithoutEffect, 900.0, 60.0, 3, Action::kAbort),
          one(Kind::kFieldMismatch, 15.0, 10.0, 5, Action::kPause),
          one(Kind::kCurrentMismatch, 0.05, 0.02, 3, Action::kAbort),
          one(Kind::kGyroSilent, silence_s, silence_s / 5.0, 1, Action::kWarn),
          one(Kind::kGyroInvalid, 20.0, 1.0, 5, Action::kPause),
          one(Kind::kCalibrationOverdue, 0.0, 0.0, 1, Action::kWarn)};
}

bool Codec<InterlockCondition>::read(const Place& at, InterlockCondition& out,
                                     const Rule& /*rule*/) {
  if (!at.value().is_object()) return at.wrong("an object");
  const Place kind = at / "kind";
  std::string expected;
  const InterlockKindInfo* found = nullptr;
  for (const InterlockKindInfo& info : kKinds) {
    expected += fmt::format("{}\"{}\"", expected.empty() ? "one of " : ", ", info.name);
    const bool same = kind.present() && kind.value().is_string() &&
                      kind.value().get_ref<const std::string&>() == info.name;
    if (same) found = &info;
  }
  if (found == nullptr) return kind.wrong(expected);
  out.kind = found->kind;
  ObjectReader reader(at);
  describe(reader, out);
  if (!reader.finish()) return false;
  const double side = worse_upwards(out.kind);
  return side * out.clear <= side * out.trip ||
         (at / found->clear_key)
             .wrong(fmt::format("at {} {} {}", side > 0.0 ? "most" : "least", found->trip_key,
                                out.trip));
}

ordered_json Codec<InterlockCondition>::schema(const Rule& /*rule*/) {
  ordered_json kinds = ordered_json::array();
  for (const InterlockKindInfo& info : kKinds) {
    SchemaWriter writer;
    InterlockCondition condition{.kind = info.kind};
    describe(writer, condition);
    kinds.push_back(writer.finish());
  }
  return {{"oneOf", kinds}};
}

ordered_json Codec<InterlockCondition>::write(const InterlockCondition& condition) {
  ObjectWriter writer;
  InterlockCondition copy = condition;
  describe(writer, copy);
  return writer.finish();
}

bool check(const Place& at, const InterlockConfig& i) {
  return i.all_of.empty() != i.any_of.empty() ||
         at.fail("expected either \"all_of\" or \"any_of\", with its conditions");
}

bool check_interlocks(const Place& at, const BenchConfig& b) {
  const double highest_c = b.limits.temperature_maximum.value;
  const double at_most_c = highest_c + kOvershoot.value;
  const auto own = auxiliary_channels(b);
  const auto is_read = [&](const std::string& channel) {
    return find_channel(channel) != nullptr ||
           std::any_of(own.begin(), own.end(), [&](const auto& c) { return c.name == channel; });
  };
  bool guarded = false;
  for (std::size_t i = 0; i < b.interlocks.size(); ++i) {
    const InterlockConfig& interlock = b.interlocks[i];
    for (std::size_t j = 0; j < i; ++j) {
      if (b.interlocks[j].name != interlock.name) continue;
      return (at / i / "name").wrong(fmt::format("another name than that of interlock {}", j));
    }
    for (const InterlockCondition& c : interlock.conditions()) {
      if (!watches_channel(c.kind) || is_read(c.channel)) continue;
      return (at / i).fail(
          fmt::format("watches the channel \"{}\", which nothing on this "
                      "bench measures",
                      c.channel));
    }
    // One condition alone, or one of several that suffice.
    if (interlock.action != InterlockAction::kAbort || interlock.all_of.size() > 1 ||
        interlock.consecutive > kSlowestGuard) {
      continue;
    }
    for (const InterlockCondition& c : interlock.conditions()) {
      guarded |= c.kind == Kind::kOverTemperature && c.trip > highest_c && c.trip <= at_most_c;
    }
  }
  return guarded ||
         at.fail(fmt::format("no over_temperature by itself aborts above temperature_maximum_c {}; "
                             "expected one with trip_c {} and consecutive {} at most",
                             highest_c, at_most_c, kSlowestGuard));
}

}  // namespace fogbench::config
