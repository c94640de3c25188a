#include "procedures/run_session.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "procedures/estimate.hpp"
#include "procedures/planned_points.hpp"
#include "procedures/settle_detector.hpp"
#include "procedures/transients.hpp"

namespace fogbench::procedures {

using drivers::from_seconds;

Status RunSession::start() {
  auto started = watch_.start();
  if (started) started = read_azimuth();
  if (!started) return started;
  starting_ = true;
  do {
    started = tick(watch_.now() + BenchWatch::kPeriod);
  } while (started && (watch_.new_row() == nullptr || interlocks_.undecided()));
  starting_ = false;
  const auto violated = interlocks_.tripped();
  if (!started || violated.empty()) return started;
  return Error{ErrorCode::kLimit, fmt::format("refused to start: {}", fmt::join(violated, "; "))};
}

Status RunSession::tick(drivers::Clock::Instant deadline) {
  const auto ticked = watch_.tick(deadline);
  if (!ticked) return ticked;
  const auto checked = check_interlocks();
  if (!checked) return checked;
  return after_tick_();
}

Status RunSession::check_interlocks() {
  if (watch_.new_row() == nullptr) return {};
  Status outcome;
  for (const InterlockChange& change : interlocks_.observe(watch_.observed(commanded()))) {
    const auto acted = act_on(change);
    if (!acted && (outcome || acted.error().code == ErrorCode::kStore)) outcome = acted;
  }
  return outcome;
}

Status RunSession::act_on(const InterlockChange& change) {
  using config::InterlockAction;
  const bool aborts = change.tripped && change.action == InterlockAction::kAbort;
  const auto noted = watch_.event(aborts ? "error" : (change.tripped ? "warning" : "info"),
                                  change.message, change.data_json);
  if (!noted || !change.tripped || starting_) return noted;
  if (aborts) return Error{ErrorCode::kLimit, change.message};
  if (change.action == InterlockAction::kWarn) return {};
  if (!operator_.can_resume()) {
    return Error{ErrorCode::kLimit,
                 change.message + "; the run is to pause, and nobody can resume it"};
  }
  pause_wanted_ = change.message;
  return {};
}

std::string RunSession::holds_pause() const {
  return fmt::format("{}", fmt::join(interlocks_.tripped(config::InterlockAction::kPause), "; "));
}

Status RunSession::tick_until(drivers::Clock::Instant deadline) {
  while (watch_.now() < deadline) {
    const auto ticked = tick(deadline);
    if (!ticked) return ticked;
  }
  return {};
}

Result<StepResult> RunSession::run(const PlannedStep& step) {
  step_ = &step;
  return std::visit([this](const auto& action) { return act(action); }, step.action);
}

Result<StepResult> RunSession::act(const SetTemperature& step) {
  drivers::Thermostat& thermostat = *bench_.thermostat;
  heating_ = step;
  // The target first: a mode that heats must never act on an old target.
  if (step.mode != HeatingMode::kOff) {
    const auto set = thermostat.set_target(step.target);
    if (!set) return set.error();
  }
  const auto switched = thermostat.set_mode(step.mode);
  if (!switched) return switched.error();
  return StepResult{};
}

Result<StepResult> RunSession::act(const SettleTemperature& step) {
  SettleDetector detector({step.band.value, step.dwell.count(), step.slope_c_per_h});
  TransientRecorder transients(config_, *bench_.gyro, watch_, step.segment, step.window,
                               [this](const Point& p) { return record(p); });
  const auto deadline = watch_.now() + from_seconds(step.timeout.count());
  while (!detector.settled()) {
    if (watch_.now() >= deadline) {
      const auto noted = watch_.event(
          "error", "temperature has not settled: " + detector.describe(), detector.evidence_json());
      if (!noted) return noted.error();
      return Error{ErrorCode::kTimeout,
                   fmt::format("the temperature did not settle within {}: {}",
                               duration_text(step.timeout), detector.describe())};
    }
    const auto ticked = tick(deadline);
    if (!ticked) return ticked.error();
    const auto recorded = transients.take();
    if (!recorded) return recorded.error();
    const MonitorRow* row = watch_.new_row();
    if (row == nullptr || std::isnan(row->thermostat.working_1.value)) continue;
    const drivers::ThermostatReading& t = row->thermostat;
    // The thermostat holds a target; else the room is where it settles.
    const bool heated = heating_ && heating_->mode != HeatingMode::kOff;
    detector.add(watch_.time_s(t.taken_at), working_temperature_c(t),
                 heated ? t.target.value : t.ambient.value);
  }
  const auto recorded = transients.finish();
  if (!recorded) return recorded.error();
  return StepResult{detector.evidence_json(), {}};
}

Result<StepResult> RunSession::act(const Wait& step) {
  TransientRecorder transients(config_, *bench_.gyro, watch_, step.segment, step.window,
                               [this](const Point& p) { return record(p); });
  const auto deadline = std::max(watch_.now() + from_seconds(step.duration.count()),
                                 watch_.power_on() + from_seconds(step.operating_time.count()));
  const Seconds wait{drivers::to_seconds(deadline - watch_.now())};
  const std::size_t due = step.segment.empty() ? 0 : windows_in(wait, step.window);
  // The first average begins with the first reading, so that the last one ends a moment after the
  // wait. One that a gap has put off is not waited for.
  const auto goes_on = [&] {
    return watch_.now() < deadline || (transients.complete() < due &&
                                       transients.next_end() < deadline + 2 * BenchWatch::kPeriod);
  };
  while (goes_on()) {
    const auto now = watch_.now();
    const auto ticked = tick(now < deadline ? deadline : now + std::chrono::milliseconds{20});
    if (!ticked) return ticked.error();
    const auto recorded = transients.take();
    if (!recorded) return recorded.error();
  }
  const auto recorded = transients.finish();
  if (!recorded) return recorded.error();
  return StepResult{};
}

Result<StepResult> RunSession::act(const Average& step) {
  PointLabels labels;
  labels.kind = step.baseline ? PointKind::kBaseline : PointKind::kAverage;
  labels.segment = step.segment;
  return measure(step.duration, labels);
}

Result<StepResult> RunSession::act(const Prompt& step) {
  const auto confirmed = operator_.confirm(step.text);
  if (!confirmed) return confirmed.error();
  if (!*confirmed) {
    return Error{ErrorCode::kAborted, "the operator declined: " + step.text};
  }
  return StepResult{};
}

Result<StepResult> RunSession::measure(Seconds duration, const PointLabels& labels) {
  std::string reason;
  for (int attempt = 1; attempt <= kTries; ++attempt) {
    // Whatever has arrived by now was measured before the window.
    auto ticked = tick(watch_.now());
    if (!ticked) return ticked.error();
    MeasurementWindow window(config_, *bench_.gyro, watch_, watch_.next_frame(), duration);
    while (!window.complete()) {
      // The last frame may come a little after it was measured.
      ticked = tick(std::max(window.end_time(), watch_.now() + std::chrono::milliseconds{20}));
      if (!ticked) return ticked.error();
      window.add(watch_.frames());
      if (watch_.new_row() != nullptr) window.add(*watch_.new_row());
    }
    reason = window.void_reason();
    if (reason.empty()) {
      const auto recorded = record(window.point(labels));
      if (!recorded) return recorded.error();
      return StepResult{};
    }
    const auto noted = watch_.event(
        "warning", fmt::format("point voided: {}; try {} of {}", reason, attempt, kTries),
        nlohmann::json{{"segment", labels.segment}, {"reason", reason}, {"try", attempt}}.dump());
    if (!noted) return noted.error();
  }
  return StepResult{{}, reason};
}

Status RunSession::record(Point point) {
  point.test = step_->test;
  point.block = step_->block;
  return on_point_(point);
}

}  // namespace fogbench::procedures
