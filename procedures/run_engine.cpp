#include "procedures/run_engine.hpp"

#include <fmt/format.h>

#include <cassert>
#include <exception>

#include "drivers/named_error.hpp"
#include "drivers/safe_state.hpp"
#include "procedures/engine_run.hpp"
#include "procedures/estimate.hpp"
#include "procedures/planned_points.hpp"
#include "procedures/run_state.hpp"

namespace fogbench::procedures {

using drivers::to_seconds;

Status RunEngine::Run::execute() {
  // Nothing of ours throws; an observer that cannot print may, and memory may run out.
  try {
    return execute_steps();
  } catch (const std::exception& error) {
    return Error{ErrorCode::kDevice, fmt::format("an unexpected error: {}", error.what())};
  } catch (...) {
    return Error{ErrorCode::kDevice, "an unexpected error without a message"};
  }
}

Status RunEngine::Run::execute_steps() {
  const auto started = session_.start();
  if (!started) return started;
  while (step_ < plan_.steps.size()) {
    Status advanced = advance();
    while (!advanced && advanced.error().code == ErrorCode::kStore && engine_.waits_for_record_) {
      advanced = await_record(advanced.error());
      if (advanced) advanced = begin_again("the run log could not be written");
    }
    if (!advanced) return advanced;
  }
  if (points_ + points_before_ == 0 && measures(plan_)) {
    return Error{ErrorCode::kStale,
                 "all steps are done and nothing was measured: every average was void, or too long "
                 "for its step"};
  }
  return {};
}

Status RunEngine::Run::advance() {
  const int block = plan_.steps[step_].block;
  if (block == 0 || block != block_) {
    const auto paused = pause_if_asked();
    if (!paused) return paused;
    block_ = block;
    block_tries_ = 1;
    block_points_ = 0;
  }
  const auto result = run_step(step_);
  if (!result && result.error().code == ErrorCode::kUnplugged) {
    return interrupt(result.error().message);
  }
  if (!result) {
    if (result.error().code == ErrorCode::kStore) return result.error();
    return Error{result.error().code, fmt::format("step {}, {}: {}", plan_.steps[step_].path,
                                                  plan_.steps[step_].says, result.error().message)};
  }
  if (!result->voided.empty()) return restart_block(result->voided);
  ++step_;
  step_tries_ = 0;
  return {};
}

Result<StepResult> RunEngine::Run::run_step(std::size_t index) {
  const PlannedStep& step = plan_.steps[index];
  step_started_ = engine_.clock_.now();
  says_ = step.says;
  const auto noted = engine_.recorder_.step_started(step.path, step.says, watch_.now_s());
  if (!noted) return noted.error();
  // An abort also takes effect before a step that never waits.
  const auto checked = after_tick();
  if (!checked) return checked.error();
  auto result = session_.run(step);
  if (!result || !result->voided.empty()) return result;
  remaining_.step_ended(index, Seconds{to_seconds(engine_.clock_.now() - step_started_)});
  const auto ended = engine_.recorder_.step_ended(step.path, watch_.now_s(), result->evidence);
  if (!ended) return ended.error();
  return result;
}

Status RunEngine::Run::after_tick() {
  if (std::string wanted = session_.take_pause(); !wanted.empty()) {
    paused_by_ = std::move(wanted);
    engine_.pause_requested_ = true;
  }
  // Before the first step there is nothing to tell.
  if (!says_.empty()) report(says_);
  if (engine_.abort_requested_) return Error{ErrorCode::kAborted, "aborted on request"};
  const Seconds elapsed{to_seconds(engine_.clock_.now() - started_)};
  const Seconds limit = engine_.config_.limits.run_time_maximum;
  if (elapsed > limit) {
    return Error{ErrorCode::kLimit,
                 "the run has lasted for the bench's limit of " + duration_text(limit)};
  }
  return {};
}

Status RunEngine::Run::record(const Point& point) {
  const auto recorded = engine_.recorder_.point(point);
  if (!recorded) return recorded;
  ++points_;
  if (point.block != 0) ++block_points_;
  if (engine_.point_) engine_.point_(point);
  return {};
}

void RunEngine::Run::enter(RunEvent event) {
  const auto next = next_state(engine_.state_, event);
  assert(next.has_value());
  engine_.state_ = *next;
}

void RunEngine::Run::report(const std::string& says) const {
  if (!engine_.progress_) return;
  const auto now = engine_.clock_.now();
  const Seconds elapsed{to_seconds(now - started_)};
  Progress progress{engine_.state_,
                    step_,
                    plan_.steps.size(),
                    says,
                    elapsed,
                    remaining_.remaining(step_, Seconds{to_seconds(now - step_started_)}),
                    Seconds{watch_.time_s(started_)},
                    {}};
  if (waits_ != nullptr) progress.waiting = {waits_->lasted(), waits_->at_most()};
  engine_.progress_(progress);
}

void RunEngine::Run::try_to_report(const std::string& says) const {
  try {
    report(says);
  } catch (...) {  // the record holds what matters
  }
}

Result<RunEnd> RunEngine::Run::finish(const Status& outcome) {
  const bool aborted = !outcome && outcome.error().code == ErrorCode::kAborted;
  enter(outcome ? RunEvent::kDone : (aborted ? RunEvent::kAbort : RunEvent::kFail));
  try_to_report("coils to 0 A, heaters off");
  const Status safe = drivers::make_safe(engine_.bench_).status();
  engine_.left_safe_ = static_cast<bool>(safe);

  RunEnd end;
  end.outcome =
      outcome ? RunOutcome::kCompleted : (aborted ? RunOutcome::kAborted : RunOutcome::kFailed);
  end.reason = outcome ? "all steps done" : outcome.error().message;
  end.safe_state_reached = static_cast<bool>(safe);
  if (!safe) {
    end.outcome = RunOutcome::kFailed;
    end.reason += "; " + safe.error().message;
  }
  end.stream = watch_.stream();
  end.ended_at = drivers::utc_text(engine_.clock_.wall_now());
  enter(
      end.outcome == RunOutcome::kCompleted
          ? RunEvent::kSafeDone
          : (end.outcome == RunOutcome::kAborted ? RunEvent::kSafeAborted : RunEvent::kSafeFailed));
  auto recorded = engine_.recorder_.end_run(end);
  // The bench is safe: what remains is to say so.
  if (!recorded && engine_.waits_for_record_ && !record_given_up_) {
    const Waits waits(*this, engine_.config_.limits.record_wait_maximum);
    while (!recorded && !engine_.abort_requested_ && !waits.too_long()) {
      try_to_report(
          fmt::format("{}; waiting for the run log: {}", end.reason, recorded.error().message));
      engine_.clock_.sleep_for(BenchWatch::kPeriod);
      recorded = engine_.recorder_.end_run(end);
    }
  }
  try_to_report(end.reason);
  if (!outcome && outcome.error().code == ErrorCode::kStore) {
    return Error{ErrorCode::kStore, end.reason + (safe ? "; the bench is in its safe state" : "")};
  }
  if (!recorded) return recorded.error();
  return end;
}

RunEngine::RunEngine(const config::BenchConfig& config, drivers::Bench& bench,
                     drivers::Clock& clock, drivers::Operator& person, Recorder& recorder)
    : config_(config), bench_(bench), clock_(clock), operator_(person), recorder_(recorder) {}

Result<std::vector<InstrumentRecord>> RunEngine::identify_instruments(
    const std::string& gyro_serial_number) {
  std::vector<InstrumentRecord> records;
  config::InstrumentConfig gyro = config_.gyro;
  gyro.serial_number = gyro_serial_number;
  const auto identify = [&](const char* role, drivers::Instrument& instrument,
                            const config::InstrumentConfig& config) -> Status {
    auto identity = instrument.identity();
    for (int i = 1; i < RunSession::kTries && !identity; ++i) identity = instrument.identity();
    if (!identity) return drivers::named(role, identity.error());
    records.push_back(
        {role, *identity, config.serial_number, config.calibrated_on, config.calibration_due});
    return {};
  };
  for (const Status& status :
       {identify("thermostat", *bench_.thermostat, config_.thermostat),
        identify("coil_horizontal", *bench_.coil_horizontal, config_.coil_horizontal),
        identify("coil_vertical", *bench_.coil_vertical, config_.coil_vertical),
        identify("magnetometer", *bench_.magnetometer, config_.magnetometer),
        identify("turntable", *bench_.turntable, config_.turntable),
        identify("gyro", *bench_.gyro, gyro)}) {
    if (!status) return status.error();
  }
  // One that is not there now may come later: its readings say when.
  for (std::size_t i = 0; i < bench_.auxiliary.size(); ++i) {
    const auto identity = bench_.auxiliary[i]->identity();
    const config::AuxiliaryConfig& its = config_.auxiliary[i];
    records.push_back({its.name, identity ? *identity : identity.error().message, its.serial_number,
                       its.calibrated_on, its.calibration_due});
  }
  return records;
}

Status RunEngine::keep_watch() {
  if (run_ == nullptr) return Error{ErrorCode::kDevice, "no run is under way"};
  return run_->keep_watch();
}

Error RunEngine::not_begun(Error why) {
  // Nobody has watched the bench since the last run.
  const Status safe = drivers::make_safe(bench_).status();
  left_safe_ = static_cast<bool>(safe);
  if (!safe) why.message += "; " + safe.error().message;
  return why;
}

Result<RunSummary> RunEngine::run(const Plan& plan, const RunHeader& header) {
  const auto running = next_state(state_, RunEvent::kStart);
  if (!running) {
    return Error{ErrorCode::kUsage,
                 fmt::format("the engine is {} and cannot start a run", name_of(state_))};
  }
  // A request is for this run only, however it ends.
  struct Forget {
    RunEngine& engine;
    ~Forget() { engine.withdraw_requests(); }
  } const forget{*this};
  const auto instruments = identify_instruments(header.gyro_serial_number);
  if (!instruments) return not_begun(instruments.error());
  const auto number = recorder_.begin_run(header, *instruments);
  if (!number) return not_begun(number.error());
  state_ = *running;

  Run run(*this, plan, header.continues ? header.continues->points : 0);
  const auto end = run.finish(run.execute());
  if (!end) return end.error();
  return RunSummary{*number, *end, run.points()};
}

}  // namespace fogbench::procedures
