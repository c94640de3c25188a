#include "procedures/transients.hpp"

#include <fmt/format.h>

namespace fogbench::procedures {

Status TransientRecorder::take(const std::function<Status(const Point&)>& record) {
  if (segment_.empty()) return {};
  if (!window_) {
    begin(watch_.next_frame());
    return {};
  }
  add();
  while (window_->complete()) {
    const std::string reason = window_->void_reason();
    std::int64_t next = window_->end();
    Status done;
    if (reason.empty()) {
      done = record(window_->point({PointKind::kTransient, segment_, std::nan(""), {}}));
    } else {
      next = watch_.next_frame();
      done = watch_.event("info", fmt::format("an average of {} left out: {}", segment_, reason));
    }
    if (!done) return done;
    begin(next);
    add();
  }
  return {};
}

void TransientRecorder::begin(std::int64_t frame) {
  window_.emplace(config_, gyro_, watch_.power_on(), frame, length_);
}

void TransientRecorder::add() {
  window_->add(watch_.frames());
  if (watch_.new_row() != nullptr) window_->add(*watch_.new_row());
}

}  // namespace fogbench::procedures
