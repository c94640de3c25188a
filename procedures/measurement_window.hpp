#pragma once
// Everything measured during one averaging window: the gyro's frames by their counter, and the slow
// readings taken between the window's first and last frame.

#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "config/bench.hpp"
#include "config/procedure.hpp"
#include "drivers/instruments.hpp"
#include "procedures/bench_watch.hpp"
#include "procedures/frame_window.hpp"
#include "procedures/recorder.hpp"
#include "procedures/sensor_window.hpp"
#include "procedures/statistics.hpp"

namespace fogbench::procedures {

/// What a point is for; the window knows only what was measured.
struct PointLabels {
  PointKind kind = PointKind::kAverage;
  std::string segment;
  /// Of a sweep; else NaN, and the pair with the larger current is reported.
  double field_set_ut = std::numeric_limits<double>::quiet_NaN();
  std::optional<config::Axis> driven;
};

class MeasurementWindow {
 public:
  /// Starts with frame `begin`. `config` and `gyro` must outlive the window; the watch lends the
  /// zero of time, the readings shortly before now, and the channels that a point needs.
  MeasurementWindow(const config::BenchConfig& config, const drivers::Gyro& gyro,
                    const BenchWatch& watch, std::int64_t begin, config::Seconds duration);

  void add(const drivers::GyroBlock& frames) { frames_.add(frames); }
  void add(const MonitorRow& row);

  bool complete() const { return frames_.complete(); }
  std::int64_t end() const { return frames_.end(); }
  drivers::Clock::Instant end_time() const { return gyro_.time_of(frames_.end()); }
  /// From when on no reading can improve the point: where the sensors lag, those just after the
  /// window tell how fast the temperature changed at its end. A point may be taken before.
  drivers::Clock::Instant last_reading_time() const;
  /// Why the window cannot be a point: a gap in the frames, or too few slow readings. Empty when it
  /// can. Precondition: complete().
  std::string void_reason() const;
  /// Test and block are the caller's. Precondition: complete(), no void_reason().
  Point point(const PointLabels& labels) const;

 private:
  const config::BenchConfig& config_;
  const drivers::Gyro& gyro_;
  drivers::Clock::Instant power_on_;
  config::Seconds duration_;
  FrameWindow frames_;
  double start_s_, end_s_;  ///< since power-on
  SensorWindow temperature_, gradient_, control_;
  Mean target_, ambient_, heater_;
  Mean field_x_, field_y_, field_z_;
  Mean current_horizontal_, current_vertical_, azimuth_;
  std::map<std::string, Mean, std::less<>> auxiliary_;
  std::span<const std::string> needed_;
};

/// The mean of the working sensors, degC; NaN when the thermostat was not read.
double working_temperature_c(const drivers::ThermostatReading& reading);

}  // namespace fogbench::procedures
