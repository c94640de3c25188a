#include "procedures/transients.hpp"

#include <fmt/format.h>

#include <cmath>

namespace fogbench::procedures {

Status TransientRecorder::take() {
  if (segment_.empty()) return {};
  if (windows_.empty()) {
    begin(watch_.next_frame());
    return {};
  }
  for (MeasurementWindow& window : windows_) {
    window.add(watch_.frames());
    if (watch_.new_row() != nullptr) window.add(*watch_.new_row());
  }
  while (windows_.back().complete()) {
    const std::string reason = windows_.back().void_reason();
    if (reason.empty()) {
      ++complete_;
      begin(windows_.back().end());
    } else {
      windows_.pop_back();
      begin(watch_.next_frame());
      auto noted =
          watch_.event("info", fmt::format("an average of {} left out: {}", segment_, reason));
      if (!noted) return noted;
    }
    windows_.back().add(watch_.frames());
  }
  while (windows_.front().complete() && windows_.front().last_reading_time() <= watch_.now()) {
    if (Status recorded = record_oldest(); !recorded) return recorded;
  }
  return {};
}

Status TransientRecorder::finish() {
  while (!windows_.empty() && windows_.front().complete()) {
    if (Status recorded = record_oldest(); !recorded) return recorded;
  }
  return {};
}

void TransientRecorder::begin(std::int64_t frame) {
  windows_.emplace_back(config_, gyro_, watch_, frame, length_);
}

Status TransientRecorder::record_oldest() {
  const Point point = windows_.front().point({PointKind::kTransient, segment_, std::nan(""), {}});
  windows_.pop_front();
  return record_(point);
}

}  // namespace fogbench::procedures
