#pragma once
// One run of the engine: which step comes next, and what follows an interruption. For
// run_engine.cpp and engine_run_interrupted.cpp only.

#include <string>

#include "procedures/bench_watch.hpp"
#include "procedures/remaining_time.hpp"
#include "procedures/run_engine.hpp"
#include "procedures/run_session.hpp"
#include "procedures/run_state.hpp"

namespace fogbench::procedures {

/// One run: goes through the plan's steps until the end or the first error.
class RunEngine::Run {
 public:
  /// An indivisible block is begun at most this often.
  static constexpr int kBlockTries = 3;

  /// `points_before`: those of the run that is taken up.
  Run(RunEngine& engine, const Plan& plan, std::size_t points_before)
      : engine_(engine),
        plan_(plan),
        watch_(engine.config_, engine.bench_, engine.clock_, engine.recorder_,
               [&engine] { return engine.abort_requested_.load(); }),
        session_(
            engine.config_, engine.bench_, engine.operator_, watch_,
            [this] { return after_tick(); }, [this](const Point& point) { return record(point); }),
        remaining_(plan),
        points_before_(points_before),
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
  Status keep_watch() { return session_.tick(engine_.clock_.now() + BenchWatch::kPeriod); }

 private:
  Status execute_steps();
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
  BenchWatch watch_;
  RunSession session_;
  RemainingTime remaining_;
  std::size_t points_before_;
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

}  // namespace fogbench::procedures
