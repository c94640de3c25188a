#pragma once
// What the condition of an interlock looks at, as one number a second, with where it was found. In
// every kind but the last more is worse, and NaN is missing: a part of the readings is missing, or
// nothing is known yet that it could be compared with.
//
//   over_temperature       the hottest of the three sensors on the carrier, degC
//   sensor_disagreement    the larger |working - control|, degC
//   heater_without_effect  how long the heating has been on with the carrier more than near_target
//                          below the target, since it last got warmer by `rise`, s
//   field_mismatch         |measured - commanded| along up or north, the larger, uT. Commanded is
//                          (I - I_zero) k of each pair: known once the ambient field is nulled.
//   current_mismatch       |measured - commanded| of either supply, the larger, A
//   gyro_silent            since the last good frame, s
//   gyro_invalid           invalid frames of all since the last look, %
//   calibration_overdue    days since calibration_due, of the instrument that has longest been due
//   channel_above          the channel's value, in its own unit; missing while it says nothing
//   channel_below          the same, where less is worse
//
// No device and no clock: all that is looked at comes with the call.

#include <array>
#include <chrono>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "config/bench.hpp"
#include "drivers/instruments.hpp"
#include "procedures/recorder.hpp"

namespace fogbench::procedures {

/// What the bench ought to be doing.
struct Commanded {
  std::optional<config::Celsius> target;  ///< nothing while the heating is off
  config::Ampere horizontal, vertical;
  /// Up and north, uT; nothing while it is not known, or not settled.
  std::optional<std::array<double, 2>> field_ut;
};

/// The bench as it is seen once a second.
struct Observation {
  MonitorRow row;
  Commanded commanded;
  drivers::StreamStatistics stream;
  double gyro_silent_s = 0.0;
  std::chrono::sys_days today{};
};

struct GaugeReading {
  double value = std::numeric_limits<double>::quiet_NaN();
  std::string where;
};

struct CalibrationDue {
  std::string instrument;
  std::chrono::sys_days day;
};
/// Of the bench's instruments that have a date.
std::vector<CalibrationDue> calibrations_of(const config::BenchConfig& bench);

/// The measured field along the pairs' axes, up and north: x is up, y points north at azimuth 0 and
/// z at 90 deg.
std::array<double, 2> along_coils_ut(const std::array<double, 3>& field_ut, config::Degree azimuth);

/// One condition's number. Keeps what some kinds need from one second to the next.
class InterlockGauge {
 public:
  InterlockGauge(const config::InterlockCondition& condition,
                 const std::vector<CalibrationDue>& calibrations)
      : condition_(condition), calibrations_(calibrations) {}

  GaugeReading measure(const Observation& seen);
  const config::InterlockCondition& condition() const { return condition_; }

 private:
  GaugeReading stalled_heating(const Observation& seen);
  GaugeReading invalid_frames(const drivers::StreamStatistics& stream);
  GaugeReading overdue(std::chrono::sys_days today) const;
  GaugeReading channel(const MonitorRow& row) const;

  config::InterlockCondition condition_;
  std::vector<CalibrationDue> calibrations_;
  /// When the heating last had an effect, and how warm the carrier was then.
  struct Effect {
    double time_s, temperature_c;
  };
  std::optional<Effect> last_effect_;
  std::optional<drivers::StreamStatistics> last_stream_;
};

}  // namespace fogbench::procedures
