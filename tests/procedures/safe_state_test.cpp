// Whatever fails, the bench ends at 0 A with its heaters off, or the end says which instrument does
// not.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/procedures/engine_fixture.hpp"

namespace fogbench::procedures {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// Runs everything with the calls failing that `fails` picks, and checks how the bench is left.
/// Returns the number of calls made.
int check_end(const std::function<bool(int, const std::string&)>& fails, const std::string& what) {
  Rig rig;
  rig.plant.fails = fails;
  const auto summary = rig.run(everything());
  if (!summary) {
    // Not begun: a bench that was safe is left as it was, whatever was answered.
    EXPECT_TRUE(rig.plant.safe()) << what;
    EXPECT_TRUE(rig.log.headers.empty()) << what;
    return rig.plant.calls;
  }
  const RunEnd& end = summary->end;
  if (end.safe_state_reached) {
    EXPECT_TRUE(rig.plant.safe()) << what << end.reason;
  } else {
    EXPECT_EQ(end.outcome, RunOutcome::kFailed) << what;
    const auto unsafe = end.reason.find("the safe state is not confirmed for");
    EXPECT_NE(unsafe, std::string::npos) << what << end.reason;
    const std::string named = end.reason.substr(std::min(unsafe, end.reason.size()));
    if (rig.plant.heater_w() != 0.0) {
      EXPECT_THAT(named, HasSubstr("thermostat")) << what;
    }
    if (rig.plant.current_a[0] != 0.0) {
      EXPECT_THAT(named, HasSubstr("coil_horizontal")) << what;
    }
    if (rig.plant.current_a[1] != 0.0) {
      EXPECT_THAT(named, HasSubstr("coil_vertical")) << what;
    }
  }
  EXPECT_EQ(rig.log.ends.size(), 1U) << what;
  return rig.plant.calls;
}

TEST(SafeState, IsReachedWhicheverCallFailsOnce) {
  const int calls = check_end([](int, const std::string&) { return false; }, "none");
  ASSERT_GT(calls, 200);
  for (int n = 1; n <= calls; ++n) {
    Rig rig;
    rig.plant.fails = [n](int call, const std::string&) { return call == n; };
    const auto summary = rig.run(everything());
    ASSERT_TRUE(summary) << n << summary.error().message;
    EXPECT_TRUE(summary->end.safe_state_reached) << n << summary->end.reason;
    EXPECT_TRUE(rig.plant.safe()) << n;
  }
}

TEST(SafeState, IsReachedOrItsFailureNamedWhicheverInstrumentDies) {
  const std::vector<std::string> instruments{"thermostat",   "coil_horizontal", "coil_vertical",
                                             "magnetometer", "turntable",       "gyro"};
  int calls = 1;
  for (const std::string& instrument : instruments) {
    for (int n = 1; n <= calls; n += 7) {
      const auto dies = [&](int call, const std::string& name) {
        return call >= n && name.starts_with(instrument);
      };
      calls = std::max(calls, check_end(dies, instrument + " at " + std::to_string(n) + ": "));
    }
  }
  EXPECT_GT(calls, 200);
}

TEST(SafeState, ADeadSupplyIsNamedInTheEnd) {
  Rig rig;
  rig.plant.fails = [&](int, const std::string& name) {
    return name.starts_with("coil_vertical") && rig.plant.current_a[1] != 0.0;
  };
  const auto summary = rig.summary_of({heat(31.0), compensate(), sweep(Axis::kY, {0.0, 50.0})});
  EXPECT_EQ(summary.end.outcome, RunOutcome::kFailed);
  EXPECT_FALSE(summary.end.safe_state_reached);
  EXPECT_THAT(summary.end.reason, HasSubstr("not confirmed for coil_vertical"));
  EXPECT_EQ(rig.plant.current_a[0], 0.0);
  EXPECT_EQ(rig.plant.heater_w(), 0.0);
}

TEST(SafeState, IsReachedWhateverTheRunLogRefuses) {
  for (const std::string call :
       {"step_started", "step_ended", "event", "point", "monitor", "gyro_samples", "end_run"}) {
    Rig rig;
    rig.log.fails = [&](const std::string& called) { return called == call; };
    // A voided point provokes an event.
    rig.plant.lost = [](std::int64_t i) { return i > 3000 && i < 3100; };
    const auto summary = rig.run({heat(31.0), wait(25.0), average(10.0)});
    ASSERT_FALSE(summary) << call;
    EXPECT_EQ(summary.error().code, ErrorCode::kStore) << call;
    EXPECT_TRUE(rig.plant.safe()) << call;
  }
}

/// A display that cannot print, while the gyro is heated and in a field.
void expect_safe_after(Rig& rig, const std::string& says) {
  const auto summary = rig.run({heat(31.0), compensate(), sweep(Axis::kY, {0.0, 50.0, 100.0})});
  ASSERT_TRUE(summary) << summary.error().message;
  EXPECT_EQ(summary->end.outcome, RunOutcome::kFailed);
  EXPECT_THAT(summary->end.reason, HasSubstr(says));
  EXPECT_TRUE(summary->end.safe_state_reached);
  ASSERT_EQ(rig.log.ends.size(), 1U);
  EXPECT_TRUE(rig.log.ends[0].safe_state_reached);
  // Read back, not remembered.
  EXPECT_EQ(rig.bench.coil_horizontal->read()->measured.value, 0.0);
  EXPECT_EQ(rig.bench.coil_vertical->read()->measured.value, 0.0);
  EXPECT_EQ(rig.bench.thermostat->read()->mode, HeatingMode::kOff);
  EXPECT_EQ(rig.bench.thermostat->read()->normal_power.value, 0.0);
}

TEST(SafeState, IsReachedWhenTheObserverOfPointsThrows) {
  Rig rig;
  bool energised = false;
  rig.engine.on_point([&](const Point& point) {
    if (point.field_set_ut != 50.0) return;
    energised = rig.plant.heater_w() > 0.0 && rig.plant.current_a[1] != 0.0;
    throw std::runtime_error("no space left on the display");
  });
  expect_safe_after(rig, "no space left on the display");
  EXPECT_TRUE(energised);
  EXPECT_EQ(rig.log.points.size(), 2U);  // on record before anyone was told
}

TEST(SafeState, IsReachedWhenTheObserverOfProgressThrowsEvenAtTheEnd) {
  Rig rig;
  int thrown = 0;
  rig.engine.on_progress([&](const Progress& now) {
    if (now.step < 2) return;
    ++thrown;
    throw 42;  // not even an exception class
  });
  expect_safe_after(rig, "an unexpected error");
  EXPECT_EQ(thrown, 3);  // in the step, when it stops, and when it has ended
}

TEST(SafeState, AnEngineRunsAgainAfterAnObserverThrew) {
  Rig rig;
  rig.engine.on_point([](const Point&) { throw std::runtime_error("once"); });
  EXPECT_EQ(rig.summary_of({average(3.0)}).end.outcome, RunOutcome::kFailed);
  rig.engine.on_point({});
  EXPECT_EQ(rig.summary_of({average(3.0)}).end.outcome, RunOutcome::kCompleted);
}

/// As somebody at the front panels left it.
void leave_energised(Rig& rig) {
  rig.plant.current_a = {3.0, -2.0};
  rig.plant.output_on = {true, true};
  rig.plant.mode = HeatingMode::kBoost;
}

TEST(SafeState, ARunThatCannotBeBegunEndsInItToo) {
  Rig unrecorded;
  leave_energised(unrecorded);
  unrecorded.log.fails = [](const std::string& call) { return call == "begin_run"; };
  EXPECT_FALSE(unrecorded.run(everything()));
  EXPECT_TRUE(unrecorded.plant.safe());
  EXPECT_TRUE(unrecorded.engine.left_safe());
  Rig unknown;
  leave_energised(unknown);
  unknown.plant.fails = [](int, const std::string& name) {
    return name == "coil_vertical.identity";
  };
  const auto summary = unknown.run(everything());
  ASSERT_FALSE(summary);
  EXPECT_THAT(summary.error().message, HasSubstr("coil_vertical: "));
  EXPECT_TRUE(unknown.plant.safe());
}

TEST(SafeState, ARunThatCannotBeBegunNamesWhoIsNotInIt) {
  Rig rig;
  leave_energised(rig);
  rig.plant.fails = [](int, const std::string& name) { return name.starts_with("coil_vertical."); };
  const auto summary = rig.run(everything());
  ASSERT_FALSE(summary);
  EXPECT_THAT(summary.error().message,
              HasSubstr("; the safe state is not confirmed for coil_vertical commanded off"));
  EXPECT_EQ(rig.plant.current_a[0], 0.0);
  EXPECT_FALSE(rig.engine.left_safe());
}

TEST(SafeState, NothingIsCommandedWhileAPlanIsMade) {
  Rig rig;
  rig.plan(everything());
  EXPECT_EQ(rig.plant.calls, 0);
}

}  // namespace
}  // namespace fogbench::procedures
