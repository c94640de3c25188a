// What interrupts a run: lost frames, silent instruments, a pause, an abort.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "procedures/bench_watch.hpp"
#include "tests/procedures/engine_fixture.hpp"

namespace fogbench::procedures {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Frames that were measured from `from_s` to `to_s`, at the fake's 100 Hz.
auto lost_between(double from_s, double to_s) {
  return [=](std::int64_t i) {
    const double t = static_cast<double>(i) / 100.0;
    return t >= from_s && t < to_s;
  };
}

TEST(Interruption, FramesLostOneByOneAreCountedAndLeftOut) {
  Rig rig;
  rig.plant.lost = [](std::int64_t i) { return i % 10 == 0; };
  rig.plant.rate = [](std::int64_t i) { return i % 10 == 0 ? 1e6 : 12.0; };
  rig.summary_of({average(10.0)});
  ASSERT_EQ(rig.log.points.size(), 1U);
  EXPECT_EQ(rig.log.points[0].count, 900U);
  EXPECT_EQ(rig.log.points[0].dropped, 100U);
  EXPECT_DOUBLE_EQ(rig.log.points[0].rate_deg_per_h, 2.0);
}

TEST(Interruption, AGapVoidsThePointWhichIsMeasuredAgain) {
  Rig rig;
  rig.plant.lost = lost_between(5.0, 5.5);
  rig.summary_of({average(10.0)});
  ASSERT_EQ(rig.log.points.size(), 1U);
  EXPECT_EQ(rig.log.points[0].count, 1000U);
  EXPECT_GT(rig.log.points[0].time_s, 14.0);
  EXPECT_TRUE(rig.log.has_event("point voided: 50 consecutive frames"));
}

TEST(Interruption, APointVoidedThreeTimesFailsTheRun) {
  Rig rig;
  rig.plant.lost = [](std::int64_t i) { return i % 200 < 50; };
  const auto summary = rig.summary_of({average(10.0)});
  EXPECT_EQ(summary.end.outcome, RunOutcome::kFailed);
  EXPECT_THAT(summary.end.reason, HasSubstr("voided 3 times"));
  EXPECT_TRUE(rig.log.points.empty());
  EXPECT_TRUE(rig.plant.safe());
}

TEST(Interruption, AnIndivisibleBlockRestartsFromItsFirstStepAndItsPointsAreVoid) {
  Rig rig;
  bool spoilt = true;
  std::vector<double> levels;
  // The second level's point cannot be measured in three tries; then the line heals.
  rig.plant.lost = [&](std::int64_t i) { return spoilt && i % 50 < 20; };
  rig.engine.on_point([&](const Point& p) { levels.push_back(p.field_set_ut); });
  rig.log.fails = [&](const std::string& call) {
    if (call == "void_block") spoilt = false;
    return false;
  };
  spoilt = false;
  rig.plant.fails = [&](int, const std::string& name) {
    if (name == "coil_horizontal.set_current" && levels.size() == 2 && rig.log.void_reasons.empty())
      spoilt = true;
    return false;
  };
  const auto summary =
      rig.summary_of({average(5.0), compensate(), sweep(Axis::kX, {0.0, 50.0, 0.0}), average(5.0)});
  EXPECT_EQ(summary.end.outcome, RunOutcome::kCompleted) << summary.end.reason;
  EXPECT_THAT(rig.log.void_reasons, ElementsAre(HasSubstr("consecutive frames")));
  ASSERT_EQ(rig.log.void_points.size(), 1U);
  EXPECT_EQ(rig.log.points.size(), 5U);
  EXPECT_EQ(summary.points, 5U);
  ASSERT_EQ(levels.size(), 6U);
  EXPECT_EQ(levels[1], 0.0);
  EXPECT_EQ(levels[2], 0.0) << "from its first level, not from where it was";
  EXPECT_EQ(levels[3], 50.0);
  EXPECT_TRUE(rig.log.has_event("indivisible block 1 interrupted, it restarts from step 3.1"));
}

TEST(Interruption, ABlockInterruptedThreeTimesFailsTheRun) {
  Rig rig;
  rig.plant.lost = [](std::int64_t i) { return i % 200 < 50; };
  const auto summary = rig.summary_of({compensate(), sweep(Axis::kX, {0.0, 50.0})});
  EXPECT_EQ(summary.end.outcome, RunOutcome::kFailed);
  EXPECT_THAT(summary.end.reason, HasSubstr("interrupted 3 times"));
  EXPECT_EQ(rig.log.void_reasons.size(), 2U);
}

TEST(Interruption, ATransientWindowWithAGapIsLeftOut) {
  Rig rig;
  rig.plant.lost = lost_between(7.0, 8.0);
  rig.summary_of({wait(30.0, "static")});
  ASSERT_EQ(rig.log.points.size(), 5U) << "one of six";
  for (const Point& p : rig.log.points) EXPECT_EQ(p.count, 500U);
  EXPECT_TRUE(rig.log.has_event("an average of static left out"));
}

TEST(Interruption, ASilentInstrumentIsBorneForHalfAMinute) {
  Rig rig;
  rig.plant.fails = [&](int, const std::string& name) {
    const auto t = rig.plant.clock.now().time_since_epoch();
    return name == "magnetometer.read" && t > std::chrono::seconds{10} &&
           t < std::chrono::seconds{30};
  };
  const auto summary = rig.summary_of({wait(5.0), average(60.0)});
  EXPECT_EQ(summary.end.outcome, RunOutcome::kCompleted) << summary.end.reason;
  EXPECT_TRUE(rig.log.has_event("magnetometer: magnetometer.read did not answer"));
  EXPECT_TRUE(rig.log.has_event("magnetometer: answers again after"));
  const auto missing = std::count_if(rig.log.rows.begin(), rig.log.rows.end(), [](const auto& r) {
    return std::isnan(r.field.field[0].value);
  });
  EXPECT_NEAR(static_cast<double>(missing), 20.0, 1.0);
  ASSERT_EQ(rig.log.points.size(), 1U);
  EXPECT_NEAR(rig.log.points[0].field_x_ut, -48.0, 1e-9);
}

TEST(Interruption, AWindowWithoutItsSlowReadingsIsVoid) {
  Rig rig;
  rig.plant.fails = [&](int, const std::string& name) {
    const auto t = rig.plant.clock.now().time_since_epoch();
    return name == "thermostat.read" && t > std::chrono::seconds{5} && t < std::chrono::seconds{13};
  };
  rig.summary_of({wait(5.0), average(10.0)});
  EXPECT_TRUE(rig.log.has_event("readings of the thermostat in 10 s; try 1 of 3"));
  ASSERT_EQ(rig.log.points.size(), 1U);
}

TEST(Interruption, AnInstrumentSilentForLongerEndsTheRun) {
  for (const std::string name : {"gyro.read", "thermostat.read", "magnetometer.read",
                                 "coil_horizontal.read", "coil_vertical.read"}) {
    Rig rig;
    rig.plant.fails = [&](int, const std::string& called) {
      return called == name && rig.plant.clock.now().time_since_epoch() > std::chrono::seconds{10};
    };
    const auto summary = rig.summary_of({wait(300.0)});
    EXPECT_EQ(summary.end.outcome, RunOutcome::kFailed) << name;
    EXPECT_THAT(summary.end.reason, HasSubstr("no reading for 30 s")) << name;
    EXPECT_LT(rig.plant.clock.now().time_since_epoch(), std::chrono::seconds{45}) << name;
  }
}

TEST(Interruption, AGyroThatNeverSpeaksFailsTheRunInTime) {
  Rig rig;
  rig.plant.lost = [](std::int64_t) { return true; };
  const auto summary = rig.summary_of({average()});
  EXPECT_EQ(summary.end.outcome, RunOutcome::kFailed);
  EXPECT_THAT(summary.end.reason, HasSubstr("gyro: no frame within 30 s"));
}

/// A magnetometer that gives one reading again and again.
class FrozenMagnetometer final : public drivers::Magnetometer {
 public:
  Result<std::string> identity() override { return std::string("frozen"); }
  Result<drivers::FieldReading> read() override { return drivers::FieldReading{}; }
};

TEST(Interruption, AReadingThatComesAgainIsStaleAndNeverAveraged) {
  Rig rig;
  rig.bench.magnetometer = std::make_unique<FrozenMagnetometer>();
  const auto summary = rig.summary_of({wait(5.0), average(10.0)});
  EXPECT_TRUE(rig.log.has_event("the same reading came again"));
  EXPECT_TRUE(rig.log.points.empty());
  EXPECT_EQ(summary.end.outcome, RunOutcome::kFailed);
}

TEST(Interruption, APauseHoldsBetweenStepsAndGoesOnAfterwards) {
  Rig rig;
  double paused_s = 0.0;
  rig.engine.on_progress([&](const Progress& p) {
    if (p.step == 0 && p.state == RunState::kRunning) rig.engine.request_pause();
    if (p.state == RunState::kPaused && ++paused_s >= 100.0) rig.engine.request_resume();
  });
  const auto summary = rig.summary_of({average(5.0), average(5.0)});
  EXPECT_EQ(summary.end.outcome, RunOutcome::kCompleted) << summary.end.reason;
  ASSERT_EQ(rig.log.points.size(), 2U);
  EXPECT_GT(rig.log.points[1].time_s - rig.log.points[0].time_s, 100.0);
  EXPECT_TRUE(rig.log.has_event("paused before: average for 5 s"));
  EXPECT_TRUE(rig.log.has_event("resumed"));
}

TEST(Interruption, APauseWaitsForTheEndOfAnIndivisibleBlock) {
  Rig rig;
  std::size_t points_when_paused = 0;
  rig.engine.on_progress([&](const Progress& p) {
    if (rig.log.points.size() == 1 && p.state == RunState::kRunning) rig.engine.request_pause();
    if (p.state == RunState::kPaused) {
      points_when_paused = rig.log.points.size();
      rig.engine.request_resume();
    }
  });
  rig.summary_of({compensate(), sweep(Axis::kX, {0.0, 50.0, 0.0}), average(5.0)});
  EXPECT_EQ(points_when_paused, 3U);
}

TEST(Interruption, AnAbortTakesEffectWithinASecondAtAnyStep) {
  const std::size_t steps = Rig{}.plan(everything()).steps.size();
  for (std::size_t at = 0; at < steps; ++at) {
    Rig rig;
    drivers::Clock::Instant asked{};
    rig.engine.on_progress([&](const Progress& p) {
      if (p.step != at || p.state != RunState::kRunning || asked != drivers::Clock::Instant{})
        return;
      asked = rig.plant.clock.now();
      rig.engine.request_abort();
    });
    const auto summary = rig.summary_of(everything());
    EXPECT_EQ(summary.end.outcome, RunOutcome::kAborted) << at;
    EXPECT_TRUE(summary.end.safe_state_reached) << at;
    EXPECT_TRUE(rig.plant.safe()) << at;
    EXPECT_LE(rig.plant.clock.now() - asked, std::chrono::seconds{1}) << at;
  }
}

/// The bench's clock, while somebody asks for an abort at a moment that no tick falls on.
class ClockWithAnAbort final : public drivers::Clock {
 public:
  ClockWithAnAbort(drivers::Clock& clock, Instant at) : clock_(clock), at_(at) {}
  Instant now() const override { return clock_.now(); }
  WallTime wall_now() const override { return clock_.wall_now(); }
  void sleep_until(Instant deadline) override {
    clock_.sleep_until(deadline);
    if (engine != nullptr && now() >= at_) engine->request_abort();
  }
  RunEngine* engine = nullptr;

 private:
  drivers::Clock& clock_;
  Instant at_;
};

TEST(Interruption, AnAbortCutsASleepShort) {
  Rig rig;
  const drivers::Clock::Instant at{std::chrono::milliseconds{5423}};
  ClockWithAnAbort clock(rig.plant.clock, at);
  RunEngine engine{rig.config, rig.bench, clock, rig.person, rig.log};
  clock.engine = &engine;
  const auto summary = engine.run(rig.plan({wait(30.0)}), RunHeader{});
  ASSERT_TRUE(summary) << summary.error().message;
  EXPECT_EQ(summary->end.outcome, RunOutcome::kAborted);
  EXPECT_TRUE(rig.plant.safe());
  EXPECT_LE(rig.plant.clock.now() - at, BenchWatch::kNap);
}

TEST(Interruption, AnAbortEndsAPauseToo) {
  Rig rig;
  rig.engine.request_pause();
  rig.engine.on_progress([&](const Progress& p) {
    if (p.state == RunState::kPaused) rig.engine.request_abort();
  });
  const auto summary = rig.summary_of({average()});
  EXPECT_EQ(summary.end.outcome, RunOutcome::kAborted);
  EXPECT_TRUE(rig.log.points.empty());
}

TEST(Interruption, AClockThatIsSetIsOnRecordAndTheRunsDatesDoNotFollow) {
  Rig rig;
  bool full = false;
  std::vector<drivers::Clock::WallTime> dates;
  rig.log.fails = [&](const std::string& call) { return full && call != "end_run"; };
  rig.engine.wait_for_record();
  rig.engine.on_progress([&, told = std::size_t{0}](const Progress&) mutable {
    auto& clock = rig.plant.clock;
    switch (++told) {
      case 5:
        clock.set_calendar(std::chrono::hours{1});
        break;
      case 10:
        clock.set_calendar(std::chrono::seconds{1});  // as a leap second
        break;
      case 15:
        clock.set_calendar(-std::chrono::hours{2});
        full = true;
        break;
      case 20:
        full = false;
        break;
      default:
        break;
    }
    dates.push_back(clock.wall_now());
  });
  const auto started = rig.plant.clock.wall_now();
  const auto summary = rig.summary_of({wait(60.0)});
  EXPECT_EQ(summary.end.outcome, RunOutcome::kCompleted) << summary.end.reason;
  std::vector<std::string> steps;
  for (const auto& event : rig.log.events) {
    if (event.data_json.find("clock_step_s") == std::string::npos) continue;
    EXPECT_EQ(event.severity, "warning");
    steps.push_back(event.data_json);
  }
  EXPECT_THAT(steps, ElementsAre(R"({"clock_step_s":3600.000})", R"({"clock_step_s":-7199.000})"));
  EXPECT_TRUE(
      rig.log.has_event("the machine's clock was set back by 7199.0 s; dates of this run "
                        "follow the clock as it was at its start"));
  EXPECT_TRUE(std::is_sorted(dates.begin(), dates.end()));
  EXPECT_EQ(summary.end.ended_at, drivers::utc_text(rig.plant.clock.wall_now()));
  EXPECT_LT(rig.plant.clock.wall_now() - started, std::chrono::minutes{3});
}

TEST(Interruption, ARequestForARunThatCannotBeBegunIsNotKeptForTheNext) {
  for (const std::string dead : {"gyro.identity", "begin_run"}) {
    Rig rig;
    rig.plant.fails = [&](int, const std::string& name) { return name == dead; };
    rig.log.fails = [&](const std::string& call) { return call == dead; };
    rig.engine.request_abort();
    rig.engine.request_pause();
    ASSERT_FALSE(rig.run({average(3.0)})) << dead;
    rig.plant.fails = [](int, const std::string&) { return false; };
    rig.log.fails = [](const std::string&) { return false; };
    EXPECT_EQ(rig.summary_of({average(3.0)}).end.outcome, RunOutcome::kCompleted) << dead;
  }
}

}  // namespace
}  // namespace fogbench::procedures
