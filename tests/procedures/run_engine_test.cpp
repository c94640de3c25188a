#include "procedures/run_engine.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/procedures/engine_fixture.hpp"

namespace fogbench::procedures {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(RunEngine, RunsEveryKindOfStepAndEndsSafe) {
  Rig rig;
  const RunSummary summary = rig.summary_of(everything());
  EXPECT_EQ(summary.end.outcome, RunOutcome::kCompleted) << summary.end.reason;
  EXPECT_TRUE(summary.end.safe_state_reached);
  EXPECT_TRUE(rig.plant.safe());
  ASSERT_EQ(rig.log.ends.size(), 1U);
  EXPECT_EQ(rig.log.ends[0].ended_at.substr(0, 13), "2026-01-01T00");
  for (const auto& s : rig.log.steps) EXPECT_TRUE(s.ended) << s.path;
  EXPECT_EQ(rig.log.points.size(), summary.points);
  EXPECT_EQ(rig.log.instrument_records.size(), 6U);
  EXPECT_EQ(rig.log.frames,
            rig.plant.clock.now().time_since_epoch() / std::chrono::milliseconds(10));
}

TEST(RunEngine, WhatWasLostBeforeARunIsNoLossOfIt) {
  Rig rig;
  const auto first = rig.summary_of({average(3.0)});
  EXPECT_EQ(first.end.stream.frames_missing, 0U);
  // Nobody measures for a minute, and half of its frames are lost.
  const auto idle = static_cast<std::int64_t>(
      100.0 * drivers::to_seconds(rig.plant.clock.now().time_since_epoch()));
  rig.plant.lost = [idle](std::int64_t i) { return i >= idle && i < idle + 3000; };
  rig.plant.clock.sleep_for(std::chrono::seconds{60});
  const auto frames = rig.log.frames;
  const auto second = rig.summary_of({average(3.0)});
  EXPECT_EQ(second.end.outcome, RunOutcome::kCompleted) << second.end.reason;
  EXPECT_EQ(second.end.stream.frames_missing, 0U);
  EXPECT_EQ(second.end.stream.frames_good, static_cast<std::uint64_t>(rig.log.frames - frames));
}

TEST(RunEngine, FillsEveryFieldOfAPoint) {
  Rig rig;
  rig.plant.rate = [](std::int64_t i) { return i % 2 == 0 ? 12.0 : 13.0; };
  rig.plant.control_offset_c = 0.25;
  rig.plant.speed_c_per_s = 0.001;
  const auto summary = rig.summary_of({heat(31.0), compensate(), sweep(Axis::kX, {100.0}, 10.0)});
  ASSERT_EQ(rig.log.points.size(), 1U) << summary.end.reason;
  const Point& p = rig.log.points[0];
  EXPECT_EQ(p.kind, PointKind::kAverage);
  EXPECT_EQ(p.segment, "coil_x/up");
  EXPECT_EQ(p.test, 1);
  EXPECT_EQ(p.block, 1);
  EXPECT_DOUBLE_EQ(p.duration_s, 10.0);
  EXPECT_EQ(p.count, 1000U);
  EXPECT_EQ(p.dropped, 0U);
  EXPECT_NEAR(p.rate_deg_per_h, 2.5, 1e-12);
  EXPECT_NEAR(p.rate_std_deg_per_h, 0.5 * std::sqrt(1000.0 / 999.0), 1e-12);
  EXPECT_NEAR(p.rate_std_error_deg_per_h, p.rate_std_deg_per_h / std::sqrt(1000.0), 1e-15);
  EXPECT_NEAR(p.temperature_rate_c_per_h, 3.6, 1e-6);
  EXPECT_NEAR(p.temperature_end_c - p.temperature_start_c, 0.01, 1e-9);
  EXPECT_NEAR(p.temperature_c, 21.0 + 0.001 * p.time_s, 1e-3);
  EXPECT_NEAR(p.temperature_gradient_c, 0.1, 1e-9);
  EXPECT_NEAR(p.temperature_control_c - p.temperature_c, 0.25, 1e-9);
  EXPECT_DOUBLE_EQ(p.target_c, 31.0);
  EXPECT_DOUBLE_EQ(p.ambient_c, 21.0);
  EXPECT_DOUBLE_EQ(p.heater_w, 5.0);
  EXPECT_NEAR(p.field_x_ut, 100.0, 0.2);
  EXPECT_NEAR(p.field_y_ut, 0.5 * 100.0 / 89.9, 0.2);
  EXPECT_NEAR(p.field_z_ut, -1.0, 1e-9);
  EXPECT_DOUBLE_EQ(p.field_set_ut, 100.0);
  EXPECT_NEAR(p.coil_current_a, 148.0 / 89.9, 0.01);
  EXPECT_DOUBLE_EQ(p.azimuth_deg, 0.0);
}

TEST(RunEngine, RecordsTransientsWindowByWindowWithoutHoles) {
  Rig rig;
  rig.plant.speed_c_per_s = 0.05;
  rig.summary_of({heat(23.0), settle(600.0, "thermostat/heating")});
  ASSERT_GE(rig.log.points.size(), 8U);
  for (std::size_t i = 0; i < rig.log.points.size(); ++i) {
    const Point& p = rig.log.points[i];
    EXPECT_EQ(p.kind, PointKind::kTransient);
    EXPECT_EQ(p.segment, "thermostat/heating");
    EXPECT_EQ(p.count, 500U);
    EXPECT_NEAR(p.time_s, rig.log.points[0].time_s + 5.0 * static_cast<double>(i), 1e-9);
  }
  EXPECT_NEAR(rig.log.points[2].temperature_rate_c_per_h, 180.0, 1e-6);
}

TEST(RunEngine, StoresTheEvidenceOfSettling) {
  Rig rig;
  rig.summary_of({heat(31.0), settle()});
  const auto evidence = nlohmann::json::parse(rig.log.steps[1].evidence);
  EXPECT_TRUE(evidence["settled"].get<bool>());
  EXPECT_GE(evidence["dwell_s"].get<double>(), 20.0);
  EXPECT_NEAR(evidence["mean_c"].get<double>(), 31.0, 0.2);
  EXPECT_LE(std::abs(evidence["slope_c_per_h"].get<double>()), 1.0);
}

TEST(RunEngine, FailsWhenTheTemperatureDoesNotSettleInTime) {
  Rig rig;
  rig.plant.speed_c_per_s = 0.001;
  const auto summary = rig.summary_of({heat(31.0), settle(100.0)});
  EXPECT_EQ(summary.end.outcome, RunOutcome::kFailed);
  EXPECT_THAT(summary.end.reason, HasSubstr("did not settle within 1 min 40 s"));
  EXPECT_THAT(summary.end.reason, HasSubstr("target of 31.000 degC"));
  EXPECT_TRUE(rig.log.has_event("temperature has not settled"));
  EXPECT_TRUE(rig.plant.safe());
}

TEST(RunEngine, SettlesToTheRoomWithTheHeatersOff) {
  Rig rig;
  rig.plant.carrier_c = 25.0;
  rig.plant.target_c = 31.0;
  const auto summary = rig.summary_of({heat(0.0, HeatingMode::kOff), settle()});
  EXPECT_EQ(summary.end.outcome, RunOutcome::kCompleted) << summary.end.reason;
  EXPECT_NEAR(rig.plant.carrier_c, 21.0, 0.2);
}

TEST(RunEngine, AWaitOfSoManyWindowsGivesSoManyPoints) {
  struct Case {
    double wait_s, window_s;
    std::size_t points;
  };
  for (const Case& c : {Case{30, 30, 1}, Case{60, 30, 2}, Case{180, 60, 3}, Case{200, 60, 3},
                        Case{3, 1, 3}, Case{119, 60, 1}}) {
    Rig rig;
    const auto summary = rig.summary_of({step(config::Wait{c.wait_s, 0.0, "static", c.window_s})});
    EXPECT_EQ(rig.log.points.size(), c.points) << c.wait_s << " s of " << c.window_s;
    EXPECT_EQ(summary.points, c.points);
    EXPECT_EQ(summary.end.outcome, RunOutcome::kCompleted) << summary.end.reason;
    const double lasted_s = drivers::to_seconds(rig.plant.clock.now().time_since_epoch());
    EXPECT_LT(lasted_s, c.wait_s + 5.0) << "no longer than it takes";
  }
}

TEST(RunEngine, ARunThatWasToMeasureAndHasNoPointHasFailed) {
  Rig rig;
  const auto summary = rig.summary_of({step(config::Wait{30.0, 0.0, "static", 60.0})});
  EXPECT_EQ(summary.end.outcome, RunOutcome::kFailed);
  EXPECT_THAT(summary.end.reason, testing::HasSubstr("nothing was measured"));
  EXPECT_TRUE(summary.end.safe_state_reached);
  EXPECT_EQ(rig.log.ends.back().outcome, RunOutcome::kFailed);

  Rig idle;
  EXPECT_EQ(idle.summary_of({wait(30.0)}).end.outcome, RunOutcome::kCompleted)
      << "it was not to measure";
}

TEST(RunEngine, WaitsForOperatingTimeSincePowerOn) {
  Rig rig;
  rig.summary_of({wait(30.0), step(config::Wait{0.0, 100.0, "", 60.0})});
  EXPECT_NEAR(drivers::to_seconds(rig.plant.clock.now().time_since_epoch()), 100.0, 0.1);
}

TEST(RunEngine, NullsTheFieldAtEachAzimuthAndSweepsFromThere) {
  Rig rig;
  const auto summary = rig.summary_of({compensate(), sweep(Axis::kX, {0.0, 50.0, -50.0, 0.0}),
                                       sweep(Axis::kY, {0.0, 50.0}), rotate(90.0), compensate(),
                                       sweep(Axis::kZ, {0.0, 50.0})});
  ASSERT_EQ(rig.log.points.size(), 8U) << summary.end.reason;
  const auto& p = rig.log.points;
  for (const Point& q : p) {
    const double along =
        q.segment[5] == 'x' ? q.field_x_ut : (q.segment[5] == 'y' ? q.field_y_ut : q.field_z_ut);
    EXPECT_NEAR(along, q.field_set_ut, 0.5) << q.segment;
  }
  std::vector<std::string> segments;
  for (const Point& q : p) segments.push_back(q.segment);
  EXPECT_THAT(segments, ElementsAre("coil_x/up", "coil_x/up", "coil_x/down", "coil_x/return",
                                    "coil_y/up", "coil_y/up", "coil_z/up", "coil_z/up"));
  EXPECT_DOUBLE_EQ(p[7].azimuth_deg, 90.0);
  const auto evidence = nlohmann::json::parse(rig.log.steps[0].evidence);
  EXPECT_LE(std::abs(evidence["residual_field_ut"][0].get<double>()), 0.2);
  EXPECT_NEAR(evidence["current_horizontal_a"].get<double>(), 48.0 / 89.9, 0.01);
}

TEST(RunEngine, EnergisesTwoAxesTogetherAndRecordsBothCurrents) {
  Rig rig;
  const config::Sweep both{Axis::kX, std::vector<double>{100.0}, 2.0, 0.0, "coil_x", -200.0};
  const config::Sweep north{Axis::kNorth, std::vector<double>{200.0}, 2.0, 0.0, "coil_north"};
  const auto summary =
      rig.summary_of({compensate(), step(both), rotate(45.0), compensate(), step(north)});
  ASSERT_EQ(rig.log.points.size(), 2U) << summary.end.reason;
  const Point& p = rig.log.points[0];
  EXPECT_NEAR(p.field_x_ut, 100.0, 1.0);
  EXPECT_NEAR(p.field_y_ut, -200.0, 1.0);
  EXPECT_DOUBLE_EQ(p.coil_current_a, p.current_horizontal_a);
  EXPECT_NEAR(p.current_vertical_a, -2.2, 0.3);  // with what nulls the ambient field
  const Point& q = rig.log.points[1];
  EXPECT_NEAR(q.field_y_ut, 200.0 / std::sqrt(2.0), 2.0);
  EXPECT_NEAR(q.field_z_ut, 200.0 / std::sqrt(2.0), 2.0);
}

TEST(RunEngine, TurnsTheGyroOnlyWithTheCoilsAtZero) {
  Rig rig;
  rig.plant.fails = [&](int, const std::string& name) {
    if (name == "turntable.rotate_to") {
      EXPECT_EQ(rig.plant.current_a[0], 0.0);
      EXPECT_EQ(rig.plant.current_a[1], 0.0);
    }
    return false;
  };
  EXPECT_EQ(rig.summary_of({compensate(), rotate(90.0)}).end.outcome, RunOutcome::kCompleted);
}

TEST(RunEngine, FailsWhenTheFieldCannotBeNulled) {
  Rig strong;
  strong.plant.ambient_ut[0] = -80.0;
  EXPECT_THAT(strong.summary_of({compensate()}).end.reason,
              HasSubstr("nulling the ambient field along the vertical takes 80.0 uT"));
  Rig restless;
  int reads = 0;
  restless.plant.fails = [&](int, const std::string& name) {
    if (name == "magnetometer.read") restless.plant.ambient_ut[0] = ++reads / 3 % 2 == 0 ? 5 : -5;
    return false;
  };
  EXPECT_THAT(restless.summary_of({compensate()}).end.reason, HasSubstr("after 10 corrections"));
}

TEST(RunEngine, FailsWhenTheTurntableHasNotTurned) {
  Rig rig;
  rig.plant.turntable_stuck = true;
  EXPECT_THAT(rig.summary_of({rotate(90.0)}).end.reason, HasSubstr("stands at 0.00 deg"));
}

TEST(RunEngine, RefusesASweepWhereTheTurntableDoesNotStandAsPlanned) {
  Rig rig;
  rig.plant.azimuth_deg = 45.0;
  EXPECT_THAT(rig.summary_of({compensate(), sweep(Axis::kY, {0.0})}).end.reason,
              HasSubstr("azimuth 45.00 deg"));
}

TEST(RunEngine, StopsARunThatLastsTooLong) {
  Rig rig;
  const Plan plan = rig.plan({heat(31.0), settle(5000.0)});
  rig.plant.speed_c_per_s = 0.0;
  rig.config.limits.run_time_maximum = Seconds{1000.0};
  const auto summary = rig.engine.run(plan, RunHeader{});
  ASSERT_TRUE(summary);
  EXPECT_THAT(summary->end.reason, HasSubstr("the bench's limit of 16 min 40 s"));
}

TEST(RunEngine, AnOperatorWhoDeclinesAborts) {
  Rig rig;
  rig.plant.operator_agrees = false;
  const auto summary = rig.summary_of({step(config::Prompt{"turn it"}), average()});
  EXPECT_EQ(summary.end.outcome, RunOutcome::kAborted);
  EXPECT_THAT(summary.end.reason, HasSubstr("declined: turn it"));
  EXPECT_TRUE(rig.log.points.empty());
}

TEST(RunEngine, SaysAndAsksBeforeTheFirstStep) {
  for (const bool agrees : {true, false}) {
    Rig rig;
    rig.plant.operator_agrees = agrees;
    RunHeader header;
    header.remarks = {"operating time counts from now"};
    header.question = "Is it on the bench?";
    const auto summary = rig.engine.run(rig.plan({average()}), header);
    ASSERT_TRUE(summary);
    EXPECT_EQ(summary->end.outcome, agrees ? RunOutcome::kCompleted : RunOutcome::kAborted);
    EXPECT_EQ(summary->points, agrees ? 1U : 0U);
    EXPECT_TRUE(rig.log.has_event("operating time counts from now"));
    EXPECT_THAT(summary->end.reason, HasSubstr(agrees ? "" : "declined: Is it on the bench?"));
    EXPECT_TRUE(rig.log.steps.empty() != agrees) << "no step before the answer";
  }
}

/// Answers after twenty seconds.
class SlowOperator final : public drivers::Operator {
 public:
  Result<bool> confirm(const std::string&) override {
    for (int second = 0; second < 20; ++second) {
      if (on_second) on_second(second);
      if (const Status kept = engine->keep_watch(); !kept) return kept.error();
    }
    return true;
  }
  RunEngine* engine = nullptr;
  std::function<void(int)> on_second;
};

TEST(RunEngine, KeepsWatchOverTheBenchWhileAnAnswerIsAwaited) {
  Rig rig;
  SlowOperator person;
  RunEngine engine{rig.config, rig.bench, rig.plant.clock, person, rig.log};
  person.engine = &engine;
  const auto summary = engine.run(rig.plan({step(config::Prompt{"turn it"})}), RunHeader{});
  ASSERT_TRUE(summary);
  EXPECT_EQ(summary->end.outcome, RunOutcome::kCompleted) << summary->end.reason;
  EXPECT_GE(rig.log.rows.size(), 20U);
}

TEST(RunEngine, AbortsWhileAnAnswerIsAwaited) {
  Rig rig;
  SlowOperator person;
  RunEngine engine{rig.config, rig.bench, rig.plant.clock, person, rig.log};
  person.engine = &engine;
  person.on_second = [&](int second) {
    EXPECT_LE(second, 5);
    if (second == 5) engine.request_abort();
  };
  const auto summary = engine.run(rig.plan({step(config::Prompt{"turn it"})}), RunHeader{});
  ASSERT_TRUE(summary);
  EXPECT_EQ(summary->end.outcome, RunOutcome::kAborted);
  EXPECT_THAT(summary->end.reason, HasSubstr("aborted on request"));
}

TEST(RunEngine, AGyroOfAnotherFrameRateIsRefusedBeforeItsTimesAreRecorded) {
  Rig rig;
  rig.plant.frame_rate_error = 0.9;
  const RunSummary summary = rig.summary_of({average(), average()});
  EXPECT_EQ(summary.end.outcome, RunOutcome::kFailed);
  EXPECT_EQ(summary.end.reason,
            "gyro: sends 90.0 frames a second by this machine's clock, expected 100 as its "
            "description states, within 0.3 %: times in the record would be 10.0 % too short");
  EXPECT_TRUE(rig.log.points.empty());
}

TEST(RunEngine, AFrameRateThatChangesLaterIsWarnedOfOnce) {
  Rig rig;
  rig.engine.on_progress([&](const Progress& p) {
    const bool off = p.elapsed > Seconds{20.0} && p.elapsed < Seconds{40.0};
    rig.plant.frame_rate_error = off ? 1.01 : 1.0;
  });
  const RunSummary summary = rig.summary_of({wait(60.0)});
  EXPECT_EQ(summary.end.outcome, RunOutcome::kCompleted) << summary.end.reason;
  ASSERT_EQ(rig.log.events.size(), 2U);
  EXPECT_EQ(rig.log.events[0].severity, "warning");
  EXPECT_THAT(rig.log.events[0].message, HasSubstr("sends 101.0 frames a second"));
  EXPECT_THAT(rig.log.events[0].message, HasSubstr("times in the record would be 1.0 % too long"));
  EXPECT_EQ(rig.log.events[0].data_json, R"({"measured_hz":101.000,"stated_hz":100})");
  EXPECT_EQ(rig.log.events[1].severity, "info");
  EXPECT_EQ(rig.log.events[1].message,
            "gyro: sends 100.0 frames a second by this machine's clock, 100 as stated again");
}

TEST(RunEngine, RecordsAPointBeforeAnyObserverSeesIt) {
  Rig rig;
  std::size_t seen = 0;
  rig.engine.on_point([&](const Point& p) {
    ++seen;
    ASSERT_EQ(rig.log.points.size(), seen);
    EXPECT_EQ(rig.log.points.back().time_s, p.time_s);
  });
  rig.summary_of({average(), average(), wait(20.0, "static")});
  EXPECT_EQ(seen, 2U + 4U);

  Rig full;
  full.log.fails = [](const std::string& call) { return call == "point"; };
  full.engine.on_point([](const Point&) { FAIL() << "seen but not recorded"; });
  EXPECT_FALSE(full.run({average()}));
}

TEST(RunEngine, ReportsProgressWithTimeThatRunsOut) {
  Rig rig;
  std::vector<Progress> all;
  rig.engine.on_progress([&](const Progress& p) { all.push_back(p); });
  rig.summary_of({wait(10.0), average(10.0), wait(20.0)});
  ASSERT_GT(all.size(), 40U);
  EXPECT_NEAR(all.front().remaining.count(), 40.0, 1e-9);
  EXPECT_EQ(all.front().says, "wait for 10 s");
  for (std::size_t i = 1; i < all.size(); ++i) {
    EXPECT_LE(all[i].remaining.count(), all[i - 1].remaining.count() + 1e-9);
  }
  EXPECT_EQ(all.back().state, RunState::kCompleted);
  EXPECT_EQ(all.back().remaining.count(), 0.0);
}

TEST(RunEngine, CorrectsTheRemainingTimeAsSettlingEnds) {
  Rig rig;
  const Plan plan = rig.plan({heat(31.0), settle(9000.0), heat(41.0), settle(9000.0)});
  std::vector<Progress> at_second;
  rig.engine.on_progress([&](const Progress& p) {
    if (p.step == 3) at_second.push_back(p);
  });
  ASSERT_TRUE(rig.engine.run(plan, RunHeader{}));
  // The fake heats 60 times faster than the estimate says: the second settling is expected to.
  EXPECT_LT(at_second.front().remaining.count(), 0.1 * plan.steps[3].estimate.count());
}

TEST(RunEngine, ARampMovesTheTargetAtItsRateAndHoldsItsEnd) {
  Rig rig;
  const auto summary =
      rig.summary_of({ramp(22.0, 72.0, "up"), wait(5.0), ramp(21.5, 36.0, "down")});
  EXPECT_EQ(summary.end.outcome, RunOutcome::kCompleted) << summary.end.reason;
  // 50 s each way, in windows of 5 s.
  ASSERT_EQ(rig.log.points.size(), 20U);
  const auto rise_c = [&](std::size_t first, std::size_t last) {
    return rig.log.points[last].temperature_c - rig.log.points[first].temperature_c;
  };
  EXPECT_NEAR(rise_c(0, 9), 45.0 * 72.0 / 3600.0, 0.15);
  EXPECT_NEAR(rise_c(2, 7), 25.0 * 72.0 / 3600.0, 0.15) << "at one rate";
  EXPECT_NEAR(rise_c(10, 19), -45.0 * 36.0 / 3600.0, 0.15);
  EXPECT_NEAR(rig.log.points[9].target_c, 22.0, 0.1);
  const auto evidence = nlohmann::json::parse(rig.log.steps[0].evidence);
  EXPECT_NEAR(evidence["from_c"].get<double>(), 21.0, 1e-9);
  EXPECT_NEAR(evidence["temperature_c"].get<double>(), 22.0, 0.2);
  EXPECT_LT(evidence["most_behind_c"].get<double>(), 0.2);
  EXPECT_FALSE(rig.log.has_event("behind"));
}

TEST(RunEngine, ARampStartsFromTheTargetThatIsHeldAndElseFromTheTemperature) {
  Rig held;
  held.plant.speed_c_per_s = 0.05;
  held.summary_of({heat(22.0), wait(17.0), ramp(23.0, 72.0)});
  EXPECT_EQ(nlohmann::json::parse(held.log.steps[2].evidence)["from_c"], 22.0);
  Rig away;
  away.plant.speed_c_per_s = 0.05;
  away.summary_of({heat(31.0), wait(19.0), ramp(23.0, 72.0)});
  EXPECT_NEAR(nlohmann::json::parse(away.log.steps[2].evidence)["from_c"].get<double>(), 22.0, 0.2);
}

TEST(RunEngine, ARampThatTheTemperatureDoesNotFollowIsOnRecordAsOne) {
  Rig rig;
  rig.plant.speed_c_per_s = 0.01;
  const auto summary = rig.summary_of({ramp(26.0, 144.0)});
  EXPECT_EQ(summary.end.outcome, RunOutcome::kCompleted);
  EXPECT_TRUE(rig.log.has_event("the ramp to 26 degC has ended, the temperature is 3."));
}

TEST(RunEngine, ARampIsAbortedAtOnceAndLeavesTheHeatersOff) {
  Rig rig;
  rig.engine.on_progress([&](const Progress& now) {
    if (now.elapsed > Seconds{20.0}) rig.engine.request_abort();
  });
  const auto summary = rig.summary_of({ramp(31.0, 36.0)});
  EXPECT_EQ(summary.end.outcome, RunOutcome::kAborted);
  EXPECT_TRUE(rig.plant.safe());
  EXPECT_LT(drivers::to_seconds(rig.plant.clock.now().time_since_epoch()), 30.0);
}

}  // namespace
}  // namespace fogbench::procedures
