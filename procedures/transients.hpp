#pragma once
// Consecutive averages while something changes: gyro and temperatures together, window by window,
// because dT/dt cannot be learned from settled plateaus.

#include <functional>
#include <optional>
#include <string>

#include "config/bench.hpp"
#include "procedures/bench_watch.hpp"
#include "procedures/measurement_window.hpp"

namespace fogbench::procedures {

class TransientRecorder {
 public:
  /// An empty segment records nothing. All references must outlive the recorder.
  TransientRecorder(const config::GyroConfig& config, const drivers::Gyro& gyro, BenchWatch& watch,
                    std::string segment, config::Seconds window)
      : config_(config),
        gyro_(gyro),
        watch_(watch),
        segment_(std::move(segment)),
        length_(window) {}

  /// Takes what the watch's last tick brought; `record` gets every window that it completes. A
  /// window with a gap is left out, with an event, and a new one starts after it.
  Status take(const std::function<Status(const Point&)>& record);

 private:
  void begin(std::int64_t frame);
  void add();

  const config::GyroConfig& config_;
  const drivers::Gyro& gyro_;
  BenchWatch& watch_;
  std::string segment_;
  config::Seconds length_;
  std::optional<MeasurementWindow> window_;
};

}  // namespace fogbench::procedures
