// An instrument is unplugged in the middle of a run: with current in the coils the bench goes to
// 0 A, the record says so, and the step or its block begins anew when the instrument is back.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/procedures/engine_fixture.hpp"

namespace fogbench::procedures {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Pulls `instrument` (as calls begin) when `when` holds first, for `for_s`.
class Unplugged {
 public:
  Unplugged(Rig& rig, std::string instrument, double for_s, std::function<bool()> when,
            int times = 1)
      : rig_(rig),
        instrument_(std::move(instrument)),
        for_s_(for_s),
        when_(std::move(when)),
        times_(times) {
    rig.plant.gone = [this](const std::string& call) { return pulled() && is_its(call); };
  }
  double pulled_at_s() const { return pulled_at_s_; }
  double now_s() const { return drivers::to_seconds(rig_.plant.clock.now().time_since_epoch()); }

 private:
  bool pulled() {
    if (times_ > 0 && now_s() > back_at_s_ && when_()) {
      --times_;
      pulled_at_s_ = now_s();
      back_at_s_ = pulled_at_s_ + for_s_;
    }
    return now_s() < back_at_s_;
  }
  bool is_its(const std::string& call) const { return call.starts_with(instrument_ + "."); }

  Rig& rig_;
  std::string instrument_;
  double for_s_;
  std::function<bool()> when_;
  int times_;
  double pulled_at_s_ = -1.0, back_at_s_ = -1.0;
};

const std::vector<std::string> kInstruments{"thermostat", "coil_horizontal", "coil_vertical",
                                            "magnetometer", "gyro"};

std::vector<config::Step> short_sweep() {
  return {compensate(), sweep(Axis::kX, {0.0, 50.0, 0.0}), average(5.0)};
}

TEST(Unplugged, InASweepTheCoilsGoToZeroAndTheSweepBeginsAnew) {
  for (const std::string& instrument : kInstruments) {
    Rig rig;
    std::vector<double> levels;
    rig.engine.on_point([&](const Point& p) { levels.push_back(p.field_set_ut); });
    const Unplugged pulled(rig, instrument, 20.0, [&] { return levels.size() == 2; });
    double zero_at_s = -1.0;
    rig.engine.on_progress([&](const Progress&) {
      const bool other_at_zero =
          rig.plant.current_a[instrument == "coil_horizontal" ? 1 : 0] == 0.0;
      if (pulled.pulled_at_s() > 0.0 && zero_at_s < 0.0 && other_at_zero)
        zero_at_s = pulled.now_s();
    });
    const auto summary = rig.summary_of(short_sweep());
    EXPECT_EQ(summary.end.outcome, RunOutcome::kCompleted) << instrument << summary.end.reason;
    EXPECT_TRUE(summary.end.safe_state_reached) << instrument;
    EXPECT_GT(zero_at_s, 0.0) << instrument;
    EXPECT_LE(zero_at_s - pulled.pulled_at_s(), 2.1) << instrument << ": reachable coils at once";
    ASSERT_EQ(levels.size(), 6U) << instrument;
    EXPECT_THAT(std::vector<double>(levels.begin() + 2, levels.begin() + 5),
                ElementsAre(0.0, 50.0, 0.0))
        << instrument;
    EXPECT_EQ(rig.log.points.size(), 4U) << instrument;
    EXPECT_EQ(rig.log.void_points.size(), 2U) << instrument;
    EXPECT_THAT(rig.log.void_reasons, ElementsAre(HasSubstr("unplugged"))) << instrument;
    EXPECT_TRUE(rig.log.has_event("unplugged; coils to 0 A until it is back")) << instrument;
    EXPECT_TRUE(rig.log.has_event("the coils read back 0 A")) << instrument;
    EXPECT_TRUE(rig.log.has_event("it restarts from step 2.1")) << instrument;
    EXPECT_NEAR(rig.log.points[1].field_x_ut, 50.0, 0.5) << instrument;
  }
}

TEST(Unplugged, ASupplyThatGoesWhileItIsSetInterruptsToo) {
  Rig rig;
  bool gone = false;
  const Unplugged pulled(rig, "coil_horizontal", 5.0, [&] { return gone; });
  rig.engine.on_point([&](const Point& p) { gone = p.field_set_ut == 50.0; });
  const auto summary = rig.summary_of(short_sweep());
  EXPECT_EQ(summary.end.outcome, RunOutcome::kCompleted) << summary.end.reason;
  EXPECT_EQ(rig.log.void_reasons.size(), 1U);
}

TEST(Unplugged, OneThatStaysAwayFailsTheRunWithTheRestAtZero) {
  for (const std::string& instrument : kInstruments) {
    Rig rig;
    const Unplugged pulled(rig, instrument, 1e9, [&] { return rig.log.points.size() == 2; });
    const auto summary = rig.summary_of(short_sweep());
    EXPECT_EQ(summary.end.outcome, RunOutcome::kFailed) << instrument;
    EXPECT_THAT(summary.end.reason, HasSubstr("unplugged")) << instrument;
    EXPECT_LE(pulled.now_s() - pulled.pulled_at_s(), 125.0) << instrument;
    const bool is_coil = instrument.starts_with("coil");
    EXPECT_EQ(summary.end.safe_state_reached, !is_coil && instrument != "thermostat") << instrument;
    EXPECT_EQ(rig.plant.current_a[instrument == "coil_horizontal" ? 1 : 0], 0.0) << instrument;
    if (is_coil) {
      EXPECT_THAT(summary.end.reason, HasSubstr(instrument));
    }
  }
}

TEST(Unplugged, TheBenchSaysHowLongItIsWaitedFor) {
  Rig rig;
  rig.config.limits.absence_maximum = Seconds{6.0};
  const Unplugged pulled(rig, "magnetometer", 1e9, [&] { return rig.log.points.size() == 2; });
  const auto summary = rig.summary_of(short_sweep());
  EXPECT_EQ(summary.end.outcome, RunOutcome::kFailed);
  EXPECT_LE(pulled.now_s() - pulled.pulled_at_s(), 11.0);
}

TEST(Unplugged, ThreeTimesInOneSweepFailsTheRun) {
  Rig rig;
  const Unplugged pulled(
      rig, "magnetometer", 3.0, [&] { return rig.log.points.size() == 1; }, 9);
  const auto summary = rig.summary_of(short_sweep());
  EXPECT_EQ(summary.end.outcome, RunOutcome::kFailed);
  EXPECT_THAT(summary.end.reason, HasSubstr("interrupted 3 times"));
  EXPECT_TRUE(rig.plant.safe());
}

TEST(Unplugged, OutsideABlockTheStepBeginsAgainWithTheCurrentsOfBefore) {
  Rig rig;
  double begun_s = -1.0;
  const Unplugged pulled(rig, "coil_vertical", 10.0,
                         [&] { return begun_s > 0 && pulled.now_s() > begun_s + 30.0; });
  rig.engine.on_progress([&](const Progress& p) {
    if (p.step == 1 && begun_s < 0.0) begun_s = pulled.now_s();
  });
  const auto summary = rig.summary_of({compensate(), average(60.0)});
  EXPECT_EQ(summary.end.outcome, RunOutcome::kCompleted) << summary.end.reason;
  ASSERT_EQ(rig.log.points.size(), 1U);
  EXPECT_EQ(rig.log.points[0].count, 6000U);
  EXPECT_NEAR(rig.log.points[0].field_y_ut, 0.0, 0.3);
  EXPECT_TRUE(rig.log.has_event("step 2 begins again"));
}

TEST(Unplugged, WithoutCurrentInTheCoilsItIsBorneForTwoMinutes) {
  Rig rig;
  const Unplugged pulled(rig, "magnetometer", 100.0, [&] { return pulled.now_s() > 10.0; });
  const auto summary = rig.summary_of({wait(200.0), average(5.0)});
  EXPECT_EQ(summary.end.outcome, RunOutcome::kCompleted) << summary.end.reason;
  EXPECT_TRUE(rig.log.has_event("magnetometer: answers again after"));
  EXPECT_FALSE(rig.log.has_event("coils to 0 A"));
}

TEST(Unplugged, AThermostatThatComesBackWithoutItsModeIsToldAgain) {
  Rig rig;
  const Unplugged pulled(rig, "thermostat", 10.0, [&] { return rig.log.points.size() == 1; });
  rig.engine.on_progress([&](const Progress&) {
    if (pulled.pulled_at_s() > 0.0 && rig.log.void_reasons.empty()) {
      rig.plant.mode = HeatingMode::kOff;
    }
  });
  const auto summary =
      rig.summary_of({heat(31.0), settle(), compensate(), sweep(Axis::kX, {0.0, 50.0, 0.0}, 10.0)});
  EXPECT_EQ(summary.end.outcome, RunOutcome::kCompleted) << summary.end.reason;
  EXPECT_TRUE(rig.log.has_event("had lost its heating mode"));
}

TEST(Unplugged, DuringAPauseTheCurrentsComeBackWithTheInstrument) {
  Rig rig;
  std::array<double, 2> before{};
  int paused = 0;
  const Unplugged pulled(rig, "magnetometer", 5.0, [&] { return paused == 10; });
  rig.engine.on_progress([&](const Progress& p) {
    if (p.step == 0) rig.engine.request_pause();
    if (p.state != RunState::kPaused) return;
    if (++paused == 5) before = rig.plant.current_a;
    if (paused == 60) rig.engine.request_resume();
  });
  const auto summary = rig.summary_of({compensate(), average(5.0)});
  EXPECT_EQ(summary.end.outcome, RunOutcome::kCompleted) << summary.end.reason;
  EXPECT_TRUE(rig.log.has_event("coils to 0 A until it is back"));
  EXPECT_NE(before[0], 0.0);
  EXPECT_NEAR(rig.log.points.at(0).field_x_ut, 0.0, 0.3);
}

TEST(Unplugged, AnAbortEndsTheWaiting) {
  Rig rig;
  const Unplugged pulled(rig, "magnetometer", 1e9, [&] { return rig.log.points.size() == 1; });
  rig.engine.on_progress([&](const Progress& p) {
    if (p.says.starts_with("waiting for an instrument")) rig.engine.request_abort();
  });
  const auto summary = rig.summary_of(short_sweep());
  EXPECT_EQ(summary.end.outcome, RunOutcome::kAborted);
  EXPECT_TRUE(summary.end.safe_state_reached);
  EXPECT_LE(pulled.now_s() - pulled.pulled_at_s(), 5.0);
}

TEST(Unplugged, ATurntableThatGoesWhileItTurnsIsToldAgain) {
  Rig rig;
  const Unplugged pulled(rig, "turntable", 15.0, [&] {
    return !rig.log.steps.empty() && rig.log.steps.back().path == "2";
  });
  const auto summary = rig.summary_of({average(3.0), rotate(90.0), average(3.0)});
  EXPECT_EQ(summary.end.outcome, RunOutcome::kCompleted) << summary.end.reason;
  EXPECT_EQ(rig.plant.azimuth_deg, 90.0);
  EXPECT_TRUE(rig.log.has_event("step 2 begins again"));
}

TEST(Unplugged, ARampWhoseThermostatIsGoneBeginsAgainFromWhereItIs) {
  Rig rig;
  const Unplugged pulled(rig, "thermostat", 10.0, [&] { return rig.plant.target_c > 21.5; });
  const auto summary = rig.summary_of({ramp(22.0, 72.0, "up")});
  EXPECT_EQ(summary.end.outcome, RunOutcome::kCompleted) << summary.end.reason;
  EXPECT_GT(pulled.pulled_at_s(), 0.0);
  ASSERT_EQ(rig.log.steps.size(), 2U) << "the ramp, and the ramp again";
  EXPECT_GT(nlohmann::json::parse(rig.log.steps[1].evidence)["from_c"].get<double>(), 21.3);
  EXPECT_NEAR(rig.plant.target_c, 22.0, 1e-9);
}

}  // namespace
}  // namespace fogbench::procedures
