// What holds a run up: a pause, an instrument that is gone, a record that cannot be written.

#include <fmt/format.h>

#include <utility>

#include "procedures/engine_run.hpp"
#include "procedures/estimate.hpp"

namespace fogbench::procedures {

using drivers::to_seconds;

Status RunEngine::Run::pause_if_asked() {
  // Nobody's resume lifts what an interlock still holds.
  if (!engine_.pause_requested_ && session_.holds_pause().empty()) {
    paused_by_.clear();
    return {};
  }
  says_ = fmt::format("paused before: {}{}{}", plan_.steps[step_].says,
                      paused_by_.empty() ? "" : "; by ", paused_by_);
  step_started_ = engine_.clock_.now();
  const auto noted = watch_.event("info", says_);
  if (!noted) return noted;
  enter(RunEvent::kPause);
  for (;;) {
    while (engine_.pause_requested_) {
      auto ticked = session_.tick(engine_.clock_.now() + BenchWatch::kPeriod);
      if (!ticked && ticked.error().code == ErrorCode::kUnplugged) {
        ticked = await_return(ticked.error().message);
      }
      while (!ticked && ticked.error().code == ErrorCode::kStore && engine_.waits_for_record_) {
        ticked = await_record(ticked.error());
      }
      if (!ticked) return ticked;
    }
    const std::string held = session_.holds_pause();
    if (held.empty()) break;
    engine_.pause_requested_ = true;
    auto refused = watch_.event("warning", "not resumed: " + held);
    while (!refused && refused.error().code == ErrorCode::kStore && engine_.waits_for_record_) {
      refused = await_record(refused.error());
    }
    if (!refused) return refused;
  }
  paused_by_.clear();
  enter(RunEvent::kResume);
  return watch_.event("info", "resumed");
}

Status RunEngine::Run::interrupt(const std::string& reason) {
  const PlannedStep& step = plan_.steps[step_];
  const auto back = await_return(reason);
  if (!back) {
    if (back.error().code == ErrorCode::kStore || back.error().code == ErrorCode::kAborted) {
      return back;
    }
    return Error{back.error().code,
                 fmt::format("step {}, {}: {}", step.path, step.says, back.error().message)};
  }
  if (step.block == 0 && ++step_tries_ == RunSession::kTries) {
    return Error{ErrorCode::kDevice, fmt::format("step {}, {}: interrupted {} times: {}", step.path,
                                                 step.says, step_tries_, reason)};
  }
  return begin_again(reason);
}

Status RunEngine::Run::begin_again(const std::string& reason) {
  const PlannedStep& step = plan_.steps[step_];
  if (step.block != 0) return restart_block(reason);
  return watch_.event("warning", fmt::format("step {} begins again: {}", step.path, reason));
}

Status RunEngine::Run::await_return(const std::string& reason) {
  auto noted = watch_.event("warning", reason + "; coils to 0 A until it is back");
  if (!noted) return noted;
  const std::string interrupted = std::exchange(says_, "waiting for an instrument: " + reason);
  const Waits waits(*this, engine_.config_.limits.absence_maximum);
  for (;;) {
    const auto off = session_.switch_off();
    // Every reading must have come since: a tick reads all of them.
    const auto ticked = session_.tick(engine_.clock_.now() + BenchWatch::kPeriod);
    if (!ticked) return ticked;
    if (off && watch_.new_row() != nullptr && watch_.all_answer()) {
      noted = watch_.event("info", fmt::format("all instruments answer after {:.1f} s, the coils "
                                               "read back 0 A",
                                               waits.lasted().count()));
      if (!noted) return noted;
      // A block sets its own currents.
      const auto restored = session_.restore(plan_.steps[step_].block == 0);
      if (restored || restored.error().code != ErrorCode::kUnplugged) {
        says_ = interrupted;
        return restored;
      }
    }
    if (waits.too_long()) {
      return Error{ErrorCode::kDevice,
                   fmt::format("still not back after {}: {}", duration_text(waits.at_most()),
                               off ? reason : off.error().message)};
    }
  }
}

Status RunEngine::Run::await_record(const Error& fault) {
  const std::string interrupted = std::exchange(says_, "waiting for the run log: " + fault.message);
  const Waits waits(*this, engine_.config_.limits.record_wait_maximum);
  watch_.keep_from_record(true);
  for (;;) {
    const auto off = session_.switch_off();
    const auto ticked = session_.tick(engine_.clock_.now() + BenchWatch::kPeriod);
    if (!ticked && ticked.error().code != ErrorCode::kUnplugged) return ticked;
    if (off && ticked) {
      const auto noted = engine_.recorder_.event(
          watch_.now_s(), "warning",
          fmt::format("{}; nothing was recorded for {:.1f} s, with the coils at 0 A", fault.message,
                      waits.lasted().count()),
          {});
      if (noted) {
        watch_.keep_from_record(false);
        const auto restored = session_.restore(plan_.steps[step_].block == 0);
        if (restored || restored.error().code != ErrorCode::kUnplugged) {
          says_ = interrupted;
          return restored;
        }
        watch_.keep_from_record(true);
      }
    }
    if (waits.too_long()) {
      record_given_up_ = true;
      return Error{ErrorCode::kDevice, fmt::format("the run log could not be written for {}: {}",
                                                   duration_text(waits.at_most()), fault.message)};
    }
  }
}

Status RunEngine::Run::restart_block(const std::string& reason) {
  const PlannedStep& step = plan_.steps[step_];
  if (block_ == 0) {
    return Error{ErrorCode::kStale, fmt::format("step {}, {}: the point was voided {} times: {}",
                                                step.path, step.says, RunSession::kTries, reason)};
  }
  if (block_tries_++ == kBlockTries) {
    return Error{ErrorCode::kStale,
                 fmt::format("step {}, {}: its indivisible block was interrupted {} times: {}",
                             step.path, step.says, kBlockTries, reason)};
  }
  while (step_ > 0 && plan_.steps[step_ - 1].block == block_) --step_;
  const auto noted =
      watch_.event("warning", fmt::format("indivisible block {} interrupted, it restarts from step "
                                          "{}: {}",
                                          block_, plan_.steps[step_].path, reason));
  if (!noted) return noted;
  points_ -= block_points_;
  block_points_ = 0;
  return engine_.recorder_.void_block(block_, watch_.now_s(), reason);
}

}  // namespace fogbench::procedures
