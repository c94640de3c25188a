#include "procedures/run_engine.hpp"

#include <fmt/format.h>

#include <cassert>
#include <exception>
#include <utility>

#include "config/roles.hpp"
#include "drivers/named_error.hpp"
#include "drivers/safe_state.hpp"
#include "procedures/bench_watch.hpp"
#include "procedures/planned_points.hpp"
#include "procedures/remaining_time.hpp"
#include "procedures/run_session.hpp"
#include "procedures/run_state.hpp"
#include "procedures/sentence.hpp"

namespace fogbench::procedures {

using drivers::to_seconds;

/// One run: goes through the plan's steps until the end or the first error.
class RunEngine::Run {
 public:
  /// An indivisible block is begun at most this often.
  static constexpr int kBlockTries = 3;

  /// All must outlive the run.
  Run(RunEngine& engine, const Plan& plan, const RunHeader& header)
      : engine_(engine),
        plan_(plan),
        header_(header),
        watch_(engine.config_, engine.bench_, engine.clock_, engine.recorder_,
               [&engine] { return engine.abort_requested_.load(); }),
        session_(
            engine.config_, engine.bench_, engine.operator_, watch_,
            [this] { return after_tick(); }, [this](const Point& point) { return record(point); }),
        remaining_(plan),
        points_before_(header.continues ? header.continues->points : 0),
        started_(engine.clock_.now()),
        step_started_(started_) {
    engine_.run_ = this;
    watch_.need(plan.needs);
  }
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;
  ~Run() { engine_.run_ = nullptr; }

  /// The error is the reason why the run ended early. Never throws.
  Status execute();
  /// The safe state and the end of the record. `outcome` is that of execute().
  Result<RunEnd> finish(const Status& outcome);
  std::size_t points() const { return points_; }
  Status note(const std::string& message, const std::string& data_json) {
    return watch_.event("info", message, data_json);
  }
  Status keep_watch() { return session_.tick(engine_.clock_.now() + BenchWatch::kPeriod); }

 private:
  Status execute_steps();
  /// What the header has to say and to ask before the first step.
  Status open();
  /// The next step, or what comes before it.
  Status advance();
  Result<StepResult> run_step(std::size_t index);
  Status pause_if_asked();
  /// An instrument was unplugged: coils to 0 A, read back, until all are there again; then the step
  /// or its block begins anew. An error when that takes too long or happens too often.
  Status interrupt(const std::string& reason);
  Status await_return(const std::string& reason);
  /// The record cannot be written: coils to 0 A until it can.
  Status await_record(const Error& fault);
  /// What an interruption leads to once it is over: the block's first step, or the step again.
  Status begin_again(const std::string& reason);
  /// Back to the block's first step, or an error when it has been tried often enough.
  Status restart_block(const std::string& reason);
  Status after_tick();
  Status record(const Point& point);
  void enter(RunEvent event);
  /// While it lives, every report tells how long something has been waited for.
  class Waits;
  void report(const std::string& says) const;
  /// Of the end: whoever displays it must not keep the bench from its safe state.
  void try_to_report(const std::string& says) const;

  RunEngine& engine_;
  const Plan& plan_;
  const RunHeader& header_;
  BenchWatch watch_;
  RunSession session_;
  RemainingTime remaining_;
  std::size_t points_before_;  ///< those of the run that is taken up
  drivers::Clock::Instant started_, step_started_;
  std::size_t step_ = 0;
  std::string says_;
  std::string paused_by_;  ///< the interlock that a pause is due to; empty for a person's
  int block_ = 0, block_tries_ = 0;
  int step_tries_ = 0;  ///< of a step outside any block
  std::size_t points_ = 0, block_points_ = 0;
  Waits* waits_ = nullptr;
  bool record_given_up_ = false;  ///< it has been waited for long enough
};

class RunEngine::Run::Waits {
 public:
  Waits(Run& run, Seconds at_most) : run_(run), at_most_(at_most), since_(now()) {
    run_.waits_ = this;
  }
  Waits(const Waits&) = delete;
  Waits& operator=(const Waits&) = delete;
  ~Waits() { run_.waits_ = nullptr; }
  Seconds lasted() const { return Seconds{drivers::to_seconds(now() - since_)}; }
  Seconds at_most() const { return at_most_; }
  bool too_long() const { return lasted() > at_most_; }

 private:
  drivers::Clock::Instant now() const { return run_.engine_.clock_.now(); }
  Run& run_;
  Seconds at_most_;
  drivers::Clock::Instant since_;
};

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
  auto started = session_.start();
  if (started) started = open();
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

Status RunEngine::Run::open() {
  for (const std::string& remark : header_.remarks) {
    if (const Status noted = watch_.event("info", remark); !noted) return noted;
  }
  if (header_.question.empty()) return {};
  says_ = "waits for an answer before the first step";
  return session_.ask(header_.question);
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
  Status known;
  config::for_each_role(
      [&](const char* role, auto& instrument, const config::InstrumentConfig& its) {
        auto identity = instrument->identity();
        for (int i = 1; i < RunSession::kTries && !identity; ++i) identity = instrument->identity();
        if (!identity) {
          if (known) known = drivers::named(role, identity.error());
          return;
        }
        records.push_back({role, *identity,
                           &its == &config_.gyro ? gyro_serial_number : its.serial_number,
                           its.calibrated_on, its.calibration_due});
      },
      bench_, config_);
  if (!known) return known.error();
  // One that is not there now may come later: its readings say when.
  for (std::size_t i = 0; i < bench_.auxiliary.size(); ++i) {
    const auto identity = bench_.auxiliary[i]->identity();
    const config::AuxiliaryConfig& its = config_.auxiliary[i];
    records.push_back({its.name, identity ? *identity : identity.error().message, its.serial_number,
                       its.calibrated_on, its.calibration_due});
  }
  return records;
}

Status RunEngine::note(const std::string& message, const std::string& data_json) {
  return run_ == nullptr ? Status{} : run_->note(message, data_json);
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

  Run run(*this, plan, header);
  const auto end = run.finish(run.execute());
  if (!end) return end.error();
  return RunSummary{*number, *end, run.points()};
}

}  // namespace fogbench::procedures
