// Each interlock in a run, on the simulated bench with the fault that it is there for: through the
// real drivers and the engine, on the virtual clock. And what each action does to a run.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "drivers/open_bench.hpp"
#include "simulator/simulated_bench.hpp"
#include "tests/procedures/engine_fixture.hpp"
#include "tests/support/source_tree.hpp"

namespace fogbench::procedures {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)
using config::FaultKind;
using config::InterlockAction;
using config::InterlockConfig;
using config::InterlockKind;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class Person final : public drivers::Operator {
 public:
  Result<bool> confirm(const std::string&) override { return true; }
  bool can_resume() const override { return there; }
  bool there = true;
};

/// The ready bench with its interlocks, without lifts and cars, a gyro of 10 Hz.
struct SimulatedRig {
  SimulatedRig() {
    static const auto ready =
        config::load_bench(tests::source_tree() / "config/benches/simulated.json");
    EXPECT_TRUE(ready) << ready.error().message;
    config = *ready;
    config.simulation.magnetic.ambient_steps_per_h = 0.0;
    config.gyro.device.frame_rate_hz = 10.0;
    config.gyro.max_gap = Seconds{1.0};
    scenario.terms = {{"bias", 0.7}};
    scenario.noise.angle_random_walk_deg_per_sqrt_h = 0.001;
  }
  RunEnd run(std::vector<config::Step> steps) {
    auto ends = simulator::simulate_bench(config, scenario, 1, clock);
    EXPECT_TRUE(ends) << ends.error().message;
    auto bench = drivers::open_bench(config, *std::move(ends), clock, person);
    EXPECT_TRUE(bench) << bench.error().message;
    RunEngine engine(config, *bench, clock, person, log);
    if (on_progress) engine.on_progress([&](const Progress& now) { on_progress(engine, now); });
    Rig planner;
    planner.config = config;
    const auto summary = engine.run(planner.plan(std::move(steps)), RunHeader{});
    EXPECT_TRUE(summary) << summary.error().message;
    return summary ? summary->end : RunEnd{};
  }
  void fault(const char* device, FaultKind kind, double at_s, double for_s) {
    scenario.faults.push_back({device, kind, Seconds{at_s}, Seconds{for_s}});
  }
  /// The events of interlocks: "name tripped", "name cleared".
  std::vector<std::string> changes() const {
    std::vector<std::string> all;
    for (const auto& event : log.events) {
      if (!event.message.starts_with("interlock ")) continue;
      const auto data = nlohmann::json::parse(event.data_json);
      all.push_back(data["interlock"].get<std::string>() + " " + data["state"].get<std::string>());
    }
    return all;
  }
  std::string severity_of(const std::string& text) const {
    for (const auto& event : log.events) {
      if (event.message.find(text) != std::string::npos) return event.severity;
    }
    return {};
  }

  config::BenchConfig config;
  config::ScenarioConfig scenario;
  drivers::VirtualClock clock;
  Person person;
  fogbench::test::MemoryRecorder log;
  std::function<void(RunEngine&, const Progress&)> on_progress;
};

InterlockConfig one(InterlockKind kind, double trip, double clear, std::uint16_t consecutive,
                    InterlockAction action) {
  return {std::string(info_of(kind).name), {{kind, trip, clear}}, {}, consecutive, action};
}

/// The run was ended by the interlock, and the bench is safe.
void expect_ended_by(const std::string& name, const RunEnd& end, const SimulatedRig& rig) {
  EXPECT_EQ(end.outcome, RunOutcome::kFailed);
  EXPECT_THAT(end.reason, HasSubstr("interlock " + name + ": "));
  EXPECT_TRUE(end.safe_state_reached);
  EXPECT_THAT(rig.changes(), ElementsAre(name + " tripped"));
  EXPECT_EQ(rig.severity_of("interlock " + name), "error");
}

TEST(InterlockedRun, OverTemperatureEndsIt) {
  SimulatedRig rig;
  rig.config.interlocks = {
      one(InterlockKind::kOverTemperature, 22.0, 21.5, 3, InterlockAction::kAbort)};
  const RunEnd end = rig.run({heat(31.0, HeatingMode::kBoost), settle(3600.0)});
  expect_ended_by("over_temperature", end, rig);
  EXPECT_THAT(end.reason, HasSubstr("trips above 22"));
}

TEST(InterlockedRun, AWorkingSensorThatLeavesTheControlOneIsWarnedOf) {
  SimulatedRig rig;
  rig.config.simulation.thermal.gradient_c_per_w = 0.3;  // it touches the heater
  const RunEnd end = rig.run({heat(31.0, HeatingMode::kBoost), wait(60.0)});
  EXPECT_EQ(end.outcome, RunOutcome::kCompleted) << end.reason;
  EXPECT_THAT(rig.changes(), ElementsAre("sensors tripped"));
  EXPECT_EQ(rig.severity_of("interlock sensors"), "warning");
}

TEST(InterlockedRun, ABrokenHeaterEndsIt) {
  SimulatedRig rig;
  rig.config.interlocks = {
      one(InterlockKind::kHeaterWithoutEffect, 120.0, 60.0, 3, InterlockAction::kAbort)};
  rig.fault("thermostat", FaultKind::kOpenCircuit, 0.0, 1e6);
  expect_ended_by("heater_without_effect", rig.run({heat(31.0), wait(600.0)}), rig);
}

TEST(InterlockedRun, APairThatMakesTooLittleFieldPausesIt) {
  SimulatedRig rig;
  rig.config.simulation.magnetic.coil_ut_per_a[0] = 60.0;  // some of the turns are shorted
  rig.config.limits.compensation_maximum = Microtesla{80.0};
  int paused_s = 0;
  rig.on_progress = [&](RunEngine& engine, const Progress& now) {
    if (now.state != RunState::kPaused) return;
    EXPECT_THAT(now.says, HasSubstr("interlock field: up: field differs"));
    if (++paused_s == 5) engine.request_abort();
  };
  const RunEnd end =
      rig.run({compensate(), sweep(Axis::kX, {0.0, 100.0, 100.0}, 10.0), average(5.0)});
  EXPECT_EQ(end.outcome, RunOutcome::kAborted) << end.reason;
  EXPECT_EQ(paused_s, 5);
  EXPECT_THAT(rig.changes(), ElementsAre("field tripped"));
  EXPECT_EQ(rig.log.points.size(), 3U) << "the sweep is not divided";
}

TEST(InterlockedRun, ASupplyThatCannotDriveItsCurrentEndsIt) {
  SimulatedRig rig;
  rig.fault("coil_horizontal", FaultKind::kOpenCircuit, 40.0, 1e6);
  const RunEnd end = rig.run({compensate(), sweep(Axis::kX, {0.0, 100.0}, 60.0)});
  expect_ended_by("current", end, rig);
  EXPECT_THAT(end.reason, HasSubstr("coil_horizontal: current differs"));
}

TEST(InterlockedRun, ASilentGyroIsWarnedOfAndSaidToBeBack) {
  SimulatedRig rig;
  rig.fault("gyro", FaultKind::kTimeout, 20.0, 10.0);
  const RunEnd end = rig.run({wait(60.0)});
  EXPECT_EQ(end.outcome, RunOutcome::kCompleted) << end.reason;
  EXPECT_THAT(rig.changes(), ElementsAre("gyro silent tripped", "gyro silent cleared"));
}

/// Its status is not valid for 12 s from 20 s on; the second step is due at 27 s.
void spoil_status(SimulatedRig& rig) {
  rig.fault("gyro", FaultKind::kException, 20.0, 12.0);
  rig.config.interlocks = {one(InterlockKind::kGyroInvalid, 20.0, 1.0, 5, InterlockAction::kPause)};
}
std::vector<config::Step> two_steps() {
  return {wait(27.0), average(5.0)};
}

TEST(InterlockedRun, APauseIsNotResumedBeforeItsReasonIsOver) {
  SimulatedRig rig;
  spoil_status(rig);
  int tried = 0;
  rig.on_progress = [&](RunEngine& engine, const Progress& now) {
    if (now.state != RunState::kPaused) return;
    ++tried;
    engine.request_resume();
  };
  const RunEnd end = rig.run(two_steps());
  EXPECT_EQ(end.outcome, RunOutcome::kCompleted) << end.reason;
  EXPECT_THAT(rig.changes(), ElementsAre("gyro_invalid tripped", "gyro_invalid cleared"));
  EXPECT_GE(tried, 4);
  EXPECT_TRUE(rig.log.has_event("not resumed: interlock gyro_invalid: gyro: frames"));
  EXPECT_TRUE(rig.log.has_event("resumed"));
  ASSERT_EQ(rig.log.points.size(), 1U);
  EXPECT_GT(rig.log.points[0].time_s, 32.0);
}

TEST(InterlockedRun, APauseWaitsForAPersonWhenItsReasonIsOver) {
  SimulatedRig rig;
  spoil_status(rig);
  int paused_s = 0;
  rig.on_progress = [&](RunEngine& engine, const Progress& now) {
    if (now.state == RunState::kPaused && ++paused_s == 30) engine.request_resume();
  };
  EXPECT_EQ(rig.run(two_steps()).outcome, RunOutcome::kCompleted);
  EXPECT_FALSE(rig.log.has_event("not resumed"));
  ASSERT_EQ(rig.log.points.size(), 1U);
  EXPECT_GT(rig.log.points[0].time_s, 55.0);
}

TEST(InterlockedRun, APauseThatNobodyCanResumeEndsIt) {
  SimulatedRig rig;
  rig.person.there = false;
  spoil_status(rig);
  const RunEnd end = rig.run(two_steps());
  EXPECT_EQ(end.outcome, RunOutcome::kFailed);
  EXPECT_THAT(end.reason, HasSubstr("interlock gyro_invalid: "));
  EXPECT_THAT(end.reason, HasSubstr("nobody can resume it"));
  EXPECT_TRUE(end.safe_state_reached);
}

TEST(InterlockedRun, ACalibrationThatEndsAtMidnightIsWarnedOf) {
  using namespace std::chrono;  // NOLINT(google-build-using-namespace)
  Rig rig;
  rig.config.interlocks = default_interlocks(rig.config);
  rig.config.magnetometer.calibration_due = "2026-01-01";  // the day on which the clock starts
  rig.plant.frame_rate_hz = 1.0;
  rig.plant.clock.sleep_for(std::chrono::seconds{86390});
  const auto summary = rig.summary_of({wait(20.0)});
  EXPECT_EQ(summary.end.outcome, RunOutcome::kCompleted) << summary.end.reason;
  EXPECT_TRUE(
      rig.log.has_event("interlock calibration_overdue: magnetometer: calibration is overdue by 1 "
                        "days (trips above 0"));
}

TEST(InterlockedRun, ACalibrationIsHeldAgainstTheDateThatTheMachineHasNow) {
  Rig rig;
  rig.config.interlocks = default_interlocks(rig.config);
  rig.config.magnetometer.calibration_due = "2026-01-01";
  rig.engine.on_progress([&, told = 0](const Progress&) mutable {
    if (++told == 5) rig.plant.clock.set_calendar(std::chrono::hours{72});
  });
  rig.summary_of({wait(20.0)});
  EXPECT_TRUE(rig.log.has_event("magnetometer: calibration is overdue by 3 days"));
}

TEST(InterlockedRun, IsRefusedForEveryInterlockThatIsViolatedAtTheStart) {
  Rig rig;
  rig.config.interlocks = default_interlocks(rig.config);
  rig.config.thermostat.calibration_due = "2025-12-24";
  rig.plant.control_offset_c = 1.5;
  const auto summary = rig.summary_of({heat(31.0), average()});
  EXPECT_EQ(summary.end.outcome, RunOutcome::kFailed);
  EXPECT_THAT(summary.end.reason,
              StartsWith("refused to start: interlock sensor_disagreement: working_2: from the "
                         "control sensor by 1.55 degC"));
  EXPECT_THAT(
      summary.end.reason,
      HasSubstr("; interlock calibration_overdue: thermostat: calibration is overdue by 8"));
  EXPECT_EQ(rig.log.events.size(), 2U) << "a line each";
  EXPECT_TRUE(rig.log.steps.empty());
  for (const std::string& command : rig.plant.commands) {
    EXPECT_THAT(command, HasSubstr("switch_off"));
  }
}

TEST(InterlockedRun, IsNotRefusedForOneBadReading) {
  Rig rig;
  rig.config.interlocks = default_interlocks(rig.config);
  rig.plant.control_offset_c = 1.5;
  rig.plant.fails = [&](int, const std::string& name) {
    if (name == "coil_horizontal.read") rig.plant.control_offset_c = 0.0;
    return false;
  };
  EXPECT_EQ(rig.summary_of({average()}).end.outcome, RunOutcome::kCompleted);
  EXPECT_TRUE(rig.log.events.empty());
}

TEST(InterlockedRun, IsAbortedWhileItsStartIsUndecided) {
  Rig rig;
  rig.config.interlocks = default_interlocks(rig.config);
  rig.plant.control_offset_c = 1.5;
  rig.plant.fails = [&](int, const std::string& name) {
    if (name == "magnetometer.read") rig.engine.request_abort();
    return false;
  };
  const auto summary = rig.summary_of({average()});
  EXPECT_EQ(summary.end.outcome, RunOutcome::kAborted) << summary.end.reason;
}

TEST(AnAbort, OfABenchThatNoLongerAnswersEndsFailedWithinTheStopLaddersTime) {
  SimulatedRig rig;
  constexpr double kSilentFrom = 20.0;
  for (const char* device : {"thermostat", "coil_horizontal", "coil_vertical", "magnetometer"}) {
    rig.fault(device, FaultKind::kTimeout, kSilentFrom, 1e6);
  }
  drivers::Clock::Instant asked{};
  rig.on_progress = [&](RunEngine& engine, const Progress&) {
    const auto now = rig.clock.now();
    if (asked != drivers::Clock::Instant{} ||
        drivers::to_seconds(now.time_since_epoch()) < kSilentFrom)
      return;
    asked = now;
    engine.request_abort();
  };
  const RunEnd end = rig.run({heat(31.0), wait(60.0)});
  ASSERT_NE(asked, drivers::Clock::Instant{});
  EXPECT_EQ(end.outcome, RunOutcome::kFailed) << "aborted means that the bench is safe";
  EXPECT_FALSE(end.safe_state_reached);
  EXPECT_THAT(end.reason, HasSubstr("aborted on request; the safe state is not confirmed for "
                                    "coil_horizontal commanded off, not confirmed ("));
  EXPECT_THAT(end.reason, HasSubstr("; coil_vertical commanded off, not confirmed ("));
  EXPECT_THAT(end.reason, HasSubstr("; thermostat commanded off, not confirmed ("));
  // Half of what the daemon gives it.
  EXPECT_LT(rig.clock.now() - asked, std::chrono::seconds{60});
}

}  // namespace
}  // namespace fogbench::procedures
