#pragma once
// Interlocks as data (the list "interlocks" of a bench file): what may not be while a run goes on,
// and what is done when it is. How each kind is measured stands in procedures/interlock_gauge.hpp.
//
// An interlock trips when its conditions hold: all of `all_of`, or one of `any_of`. A condition
// holds above its trip threshold and is over at or below its clear threshold; in between nothing
// changes (hysteresis). Of every kind more is worse, but of channel_below, which looks downwards.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "config/units.hpp"

namespace fogbench::config {

struct BenchConfig;

enum class InterlockKind {
  kOverTemperature,
  kSensorDisagreement,
  kHeaterWithoutEffect,
  kFieldMismatch,
  kCurrentMismatch,
  kGyroSilent,
  kGyroInvalid,
  kCalibrationOverdue,
  kChannelAbove,
  kChannelBelow
};

enum class InterlockAction { kWarn, kPause, kAbort };

struct InterlockCondition {
  InterlockKind kind = InterlockKind::kOverTemperature;
  double trip = 0.0;  ///< in the kind's unit
  double clear = 0.0;
  /// Of kHeaterWithoutEffect only: so much warmer is an effect, and this near to the target none is
  /// asked for.
  Celsius rise{0.5};
  Celsius near_target{2.0};
  /// Of kChannelAbove and kChannelBelow only: a channel that the bench monitors, or an auxiliary
  /// sensor's.
  std::string channel;
};

struct InterlockConfig {
  std::string name;
  std::vector<InterlockCondition> all_of, any_of;  ///< one of the two is empty
  /// Seconds in a row, one look at the bench each, that the conditions must hold for.
  std::uint16_t consecutive = 3;
  InterlockAction action = InterlockAction::kWarn;

  const std::vector<InterlockCondition>& conditions() const {
    return all_of.empty() ? any_of : all_of;
  }
};

/// A kind in words: how files name it and its thresholds, and how its value is told.
struct InterlockKindInfo {
  InterlockKind kind;
  std::string_view name;
  std::string_view trip_key, clear_key;
  double lowest;  ///< threshold
  std::string_view unit;
  std::string_view says;  ///< stands before the value: "no frame for" 6 s
  std::string_view description;
};

/// In the order of the enumeration.
std::span<const InterlockKindInfo> interlock_kinds();
const InterlockKindInfo& info_of(InterlockKind kind);
/// Of its value: the kind's, or the channel's.
std::string_view unit_of(const InterlockCondition& condition);
std::string_view name_of(InterlockAction action);
constexpr bool watches_channel(InterlockKind kind) {
  return kind == InterlockKind::kChannelAbove || kind == InterlockKind::kChannelBelow;
}
/// +1: it trips above its threshold; -1: below.
constexpr double worse_upwards(InterlockKind kind) {
  return kind == InterlockKind::kChannelBelow ? -1.0 : 1.0;
}

/// How far above the bench's highest temperature a controller may overshoot, and nothing else.
inline constexpr Celsius kOvershoot{2.0};

/// What a bench that lists none has, with thresholds that fit its limits and its gyro.
std::vector<InterlockConfig> default_interlocks(const BenchConfig& bench);

}  // namespace fogbench::config
