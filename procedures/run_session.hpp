#pragma once
// One run's steps on the bench: what each kind of step does, on top of the watch. Which step comes
// next, and what an end means, is the run engine's.

#include <array>
#include <functional>
#include <optional>
#include <string>

#include "config/bench.hpp"
#include "drivers/instruments.hpp"
#include "procedures/bench_watch.hpp"
#include "procedures/interlocks.hpp"
#include "procedures/measurement_window.hpp"
#include "procedures/plan.hpp"
#include "procedures/recorder.hpp"

namespace fogbench::procedures {

/// How a step ended.
struct StepResult {
  std::string evidence;  ///< JSON, may be empty
  std::string voided;    ///< why its point could not be measured; empty when the step is done
};

class RunSession {
 public:
  /// What happens with every tick besides the bench's own: abort, progress.
  using AfterTick = std::function<Status()>;
  using OnPoint = std::function<Status(const Point&)>;

  /// A point is measured at most this often before its step is given up.
  static constexpr int kTries = 3;

  /// All must outlive the session.
  RunSession(const config::BenchConfig& config, drivers::Bench& bench, drivers::Operator& person,
             BenchWatch& watch, AfterTick after_tick, OnPoint on_point)
      : config_(config),
        bench_(bench),
        operator_(person),
        watch_(watch),
        interlocks_(config),
        after_tick_(std::move(after_tick)),
        on_point_(std::move(on_point)) {}

  /// The stream's first frame, the first readings, and the interlocks: kLimit when one of them is
  /// violated already. Commands nothing.
  Status start();
  /// kLimit for an interlock that aborts.
  Status tick(drivers::Clock::Instant deadline);
  /// kUnplugged when an instrument was gone that the step, or a field, depends on: the coils are to
  /// be switched off and the step begun again when it is back.
  Result<StepResult> run(const PlannedStep& step);

  /// kAborted when the operator declines.
  Status ask(const std::string& text);

  /// Why an interlock wants the run to pause, once; empty when none does.
  std::string take_pause() { return std::exchange(pause_wanted_, {}); }
  /// Interlocks that keep the run paused: not cleared yet. Empty when there are none.
  std::string holds_pause() const;

  /// One try to bring the coils to 0 A, read back, output off; and to reach whatever the watch does
  /// not read. Done when it returns no error.
  Status switch_off();
  /// After switch_off(): the heating as it was commanded, where the thermostat has forgotten it,
  /// and with `currents` the coils as they were.
  Status restore(bool currents);

 private:
  Result<StepResult> act(const SetTemperature& step);
  Result<StepResult> act(const Ramp& step);
  Result<StepResult> act(const SettleTemperature& step);
  Result<StepResult> act(const Wait& step);
  Result<StepResult> act(const Average& step);
  Result<StepResult> act(const CompensateField& step);
  Result<StepResult> act(const SweepLevel& step);
  Result<StepResult> act(const Rotate& step);
  Result<StepResult> act(const Prompt& step);

  /// Until `deadline`, recording consecutive averages where there is a segment. `each` is called
  /// after every tick.
  Status record_until(drivers::Clock::Instant deadline, const std::string& segment, Seconds window,
                      const std::function<Status()>& each);
  /// Where a ramp starts: the target that is held, or the temperature as it is.
  Result<Celsius> ramp_start();

  /// Measures one point and records it; up to kTries windows.
  Result<StepResult> measure(Seconds duration, const PointLabels& labels);
  Status record(Point point);
  Status tick_until(drivers::Clock::Instant deadline);

  /// Looks at a new row: records what trips and clears, and does what it asks for.
  Status check_interlocks();
  Status act_on(const InterlockChange& change);
  Commanded commanded() const;

  Status energise();
  Status set_currents(config::Ampere horizontal, config::Ampere vertical);
  /// The mean of a few fresh readings, gyro axes, uT.
  Result<std::array<double, 3>> measure_field();
  Status read_azimuth();

  const config::BenchConfig& config_;
  drivers::Bench& bench_;
  drivers::Operator& operator_;
  BenchWatch& watch_;
  Interlocks interlocks_;
  bool starting_ = false;  ///< what trips refuses the run
  std::string pause_wanted_;
  AfterTick after_tick_;
  OnPoint on_point_;
  const PlannedStep* step_ = nullptr;

  /// The last that was commanded; nothing before the first.
  std::optional<SetTemperature> heating_;
  Degree azimuth_{0.0};
  bool energised_ = false;
  config::Ampere horizontal_, vertical_;  ///< as set
  drivers::Clock::Instant currents_since_{};
  /// What the coils carried when they were first switched off; nothing when they carry it still.
  std::optional<std::array<config::Ampere, 2>> switched_off_;
  /// Currents that null the ambient field at this azimuth.
  std::optional<std::array<config::Ampere, 2>> zero_;
};

}  // namespace fogbench::procedures
