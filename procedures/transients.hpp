#pragma once
// Consecutive averages while something changes: gyro and temperatures together, window by window,
// because dT/dt cannot be learned from settled plateaus.

#include <deque>
#include <functional>
#include <string>

#include "config/bench.hpp"
#include "procedures/bench_watch.hpp"
#include "procedures/measurement_window.hpp"

namespace fogbench::procedures {

class TransientRecorder {
 public:
  /// An empty segment records nothing. All references must outlive the recorder. `record` gets
  /// every window, in order.
  TransientRecorder(const config::BenchConfig& config, const drivers::Gyro& gyro, BenchWatch& watch,
                    std::string segment, config::Seconds window,
                    std::function<Status(const Point&)> record)
      : config_(config),
        gyro_(gyro),
        watch_(watch),
        segment_(std::move(segment)),
        length_(window),
        record_(std::move(record)) {}

  /// Takes what the watch's last tick brought. A window with a gap is left out, with an event, and
  /// a new one starts after it.
  Status take();
  /// Windows that have all their frames, and when the one under way will have them.
  std::size_t complete() const { return complete_; }
  /// Precondition: take() has been called, and a segment is recorded.
  drivers::Clock::Instant next_end() const { return windows_.back().end_time(); }
  /// Records the windows that have all their frames but still wait for readings after their end.
  Status finish();

 private:
  void begin(std::int64_t frame);
  Status record_oldest();

  const config::BenchConfig& config_;
  const drivers::Gyro& gyro_;
  BenchWatch& watch_;
  std::string segment_;
  config::Seconds length_;
  std::function<Status(const Point&)> record_;
  std::size_t complete_ = 0;
  std::deque<MeasurementWindow> windows_;  ///< oldest first; only the last lacks frames
};

}  // namespace fogbench::procedures
