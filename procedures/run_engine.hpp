#pragma once
// Executes a plan on a bench. Single-threaded: run() blocks until the bench is in its safe state.
//
//            start            pause            resume
//   kIdle ─────────► kRunning ──────► kPaused ────────► kRunning
//                       │  step fails / abort / done        │ abort
//                       ▼                                   ▼
//                   kStopping (coils to 0 A, heaters off, both read back)
//                       │
//                       ▼
//            kCompleted | kAborted | kFailed
//
// The states and events are a transition table in run_state.cpp; an event that the table does not
// list for a state is refused.

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "config/bench.hpp"
#include "config/result.hpp"
#include "drivers/clock.hpp"
#include "drivers/instruments.hpp"
#include "procedures/plan.hpp"
#include "procedures/recorder.hpp"

namespace fogbench::procedures {

enum class RunState { kIdle, kRunning, kPaused, kStopping, kCompleted, kAborted, kFailed };

/// What a display needs; delivered on the thread of run().
struct Progress {
  RunState state = RunState::kIdle;
  std::size_t step = 0;  ///< index into the plan
  std::size_t steps = 0;
  std::string says;
  Seconds elapsed{0.0};    ///< since the run began, on the bench's clock
  Seconds remaining{0.0};  ///< the plan's estimate, corrected as steps end
  Seconds started{0.0};    ///< when the run began, since the gyro's power-on as the record's times
  /// For an instrument, or for the run log: the run fails when it has lasted too long.
  struct Waiting {
    Seconds lasted{0.0}, at_most{0.0};
  };
  std::optional<Waiting> waiting;
};

struct RunSummary {
  std::int64_t run = 0;
  RunEnd end;
  std::size_t points = 0;  ///< recorded, without those of abandoned blocks
};

class RunEngine {
 public:
  /// All must outlive the engine. `clock` is the one the bench was opened with.
  RunEngine(const config::BenchConfig& config, drivers::Bench& bench, drivers::Clock& clock,
            drivers::Operator& person, Recorder& recorder);

  /// Observers are called on the thread of run(), about once a second; they must not call run().
  /// One that throws ends the run as failed, in the safe state.
  void on_progress(std::function<void(const Progress&)> observer) {
    progress_ = std::move(observer);
  }
  /// Called when the point is on disk, never before.
  void on_point(std::function<void(const Point&)> observer) { point_ = std::move(observer); }

  /// A record that cannot be written (a full disk, another program's lock) is waited for as an
  /// instrument is: coils at 0 A, at most for the bench's record_wait_maximum, then the step or its
  /// block begins anew. Without this it ends the run: on a virtual clock nobody makes room in time.
  void wait_for_record() { waits_for_record_ = true; }

  /// Ends in the safe state whatever happens. An error is returned only when the run could not
  /// be recorded (kStore) or begun, the bench is made safe all the same; a failed or aborted run is
  /// a RunSummary that says so. An engine may run again after an end.
  Result<RunSummary> run(const Plan& plan, const RunHeader& header);

  /// Whether every actuator was off, read back, after the last call of run(), or run() was never
  /// called.
  bool left_safe() const { return left_safe_; }

  /// Asks each instrument who it is. The gyro under test comes and goes: its serial number is the
  /// run's, the others' are the bench's. Errors: the instrument's.
  Result<std::vector<InstrumentRecord>> identify_instruments(const std::string& gyro_serial_number);

  /// For an operator whose answer takes time: called from within confirm() again and again until it
  /// has come. Keeps watch over the bench for up to a second. An error (an abort, an instrument
  /// that is gone) means that nobody need answer any more: confirm() returns it.
  Status keep_watch();

  /// An event of the run under way; nothing where there is none. Called from within confirm().
  Status note(const std::string& message, const std::string& data_json);

  // Thread- and signal-safe requests; take effect within BenchWatch::kNap (abort) or before the
  // next step outside an indivisible block (pause). One asked for before run() holds for that run,
  // and for no later one.
  void request_abort() { abort_requested_ = true; }
  void request_pause() { pause_requested_ = true; }
  void request_resume() { pause_requested_ = false; }
  /// Nothing is asked for any more.
  void withdraw_requests() { abort_requested_ = pause_requested_ = false; }

 private:
  class Run;

  /// The error of a run that did not begin, with whatever is not off.
  Error not_begun(Error why);

  const config::BenchConfig& config_;
  drivers::Bench& bench_;
  drivers::Clock& clock_;
  drivers::Operator& operator_;
  Recorder& recorder_;
  std::function<void(const Progress&)> progress_;
  std::function<void(const Point&)> point_;
  RunState state_ = RunState::kIdle;
  bool waits_for_record_ = false;
  bool left_safe_ = true;
  Run* run_ = nullptr;  ///< the one under way
  std::atomic<bool> abort_requested_{false};
  std::atomic<bool> pause_requested_{false};
};

}  // namespace fogbench::procedures
