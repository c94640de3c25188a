// The record cannot be written for a while (a full disk, another program's lock): the bench goes to
// 0 A and waits for room, and what could not be recorded is measured anew.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/procedures/engine_fixture.hpp"

namespace fogbench::procedures {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)
using ::testing::HasSubstr;

/// The record fails from the n-th call of that kind on, for `for_s`.
class FullDisk {
 public:
  FullDisk(Rig& rig, std::string call, int at, double for_s) {
    rig.log.fails = [this, &rig, call = std::move(call), at, for_s](const std::string& now) {
      const double now_s = drivers::to_seconds(rig.plant.clock.now().time_since_epoch());
      if (begun_s_ < 0.0 && now == call && ++calls_ == at) begun_s_ = now_s;
      const bool full = begun_s_ >= 0.0 && now_s < begun_s_ + for_s;
      failures_ += full ? 1 : 0;
      return full;
    };
  }
  int failures() const { return failures_; }

 private:
  double begun_s_ = -1.0;
  int calls_ = 0, failures_ = 0;
};

std::vector<std::string> segments(const std::vector<Point>& points) {
  std::vector<std::string> names;
  for (const Point& point : points) {
    if (point.kind != PointKind::kTransient) names.push_back(point.segment);
  }
  return names;
}

TEST(LostRecord, WhateverCallFailsTheRunWaitsAndLosesNothing) {
  Rig undisturbed;
  undisturbed.summary_of(everything());
  for (const std::string call :
       {"step_started", "step_ended", "event", "point", "monitor", "gyro_samples"}) {
    // The first frames and readings are the start of the run: without a record it does not begin.
    for (const int at : {call == "gyro_samples" || call == "monitor" ? 2 : 1, 3, 6}) {
      const std::string where = call + " " + std::to_string(at);
      Rig rig;
      rig.engine.wait_for_record();
      std::size_t reported = 0;
      rig.engine.on_point([&](const Point&) { ++reported; });
      const FullDisk disk(rig, call, at, 30.0);
      const auto summary = rig.summary_of(everything());
      EXPECT_EQ(summary.end.outcome, RunOutcome::kCompleted) << where << summary.end.reason;
      EXPECT_TRUE(summary.end.safe_state_reached) << where;
      EXPECT_EQ(segments(rig.log.points), segments(undisturbed.log.points)) << where;
      EXPECT_EQ(reported, rig.log.points.size() + rig.log.void_points.size()) << where;
      if (disk.failures() > 1) {
        EXPECT_TRUE(rig.log.has_event("nothing was recorded for")) << where;
      }
    }
  }
}

TEST(LostRecord, MeanwhileTheCoilsCarryNothingAndTheHeatIsHeld) {
  Rig rig;
  rig.engine.wait_for_record();
  const FullDisk disk(rig, "point", 3, 60.0);
  double most_a = 0.0;
  bool waited = false;
  rig.engine.on_progress([&](const Progress& now) {
    if (now.says.find("waiting for the run log") == std::string::npos) return;
    if (waited)
      most_a =
          std::max({most_a, std::abs(rig.plant.current_a[0]), std::abs(rig.plant.current_a[1])});
    waited = true;
  });
  const auto summary = rig.summary_of({heat(31.0), settle(), compensate(), average(),
                                       sweep(Axis::kX, {0.0, 100.0, 0.0}), average()});
  EXPECT_EQ(summary.end.outcome, RunOutcome::kCompleted) << summary.end.reason;
  EXPECT_TRUE(waited);
  EXPECT_EQ(most_a, 0.0);
  EXPECT_EQ(rig.log.void_points.size(), 1U) << "the sweep begins anew";
  EXPECT_NEAR(rig.log.points.back().temperature_c, 31.0, 0.3);
}

TEST(LostRecord, ThatNeverComesBackEndsTheRunInTheSafeState) {
  Rig rig;
  rig.config.limits.record_wait_maximum = Seconds{120.0};
  rig.config.limits.absence_maximum = Seconds{86400.0};
  rig.engine.wait_for_record();
  const FullDisk disk(rig, "point", 2, 1e9);
  const auto summary =
      rig.run({heat(31.0), compensate(), average(), sweep(Axis::kX, {0.0, 100.0})});
  ASSERT_FALSE(summary) << "its end is not on record either";
  EXPECT_EQ(summary.error().code, ErrorCode::kStore);
  EXPECT_EQ(rig.plant.current_a[0], 0.0);
  EXPECT_EQ(rig.plant.current_a[1], 0.0);
  EXPECT_LT(drivers::to_seconds(rig.plant.clock.now().time_since_epoch()), 200.0)
      << "waited for once, not again for its end";
}

TEST(LostRecord, IsWaitedForAFactorysNightUnlessTheBenchSaysOtherwise) {
  EXPECT_EQ(config::BenchLimits{}.record_wait_maximum, Seconds{12 * 3600.0});
  Rig rig;
  rig.config.limits.absence_maximum = Seconds{5.0};
  rig.config.limits.record_wait_maximum = Seconds{600.0};
  rig.engine.wait_for_record();
  const FullDisk disk(rig, "point", 2, 300.0);
  std::vector<double> lasted_s;
  rig.engine.on_progress([&](const Progress& now) {
    if (!now.waiting) return;
    lasted_s.push_back(now.waiting->lasted.count());
    EXPECT_EQ(now.waiting->at_most, Seconds{600.0});
  });
  const auto summary = rig.summary_of({compensate(), average(), average()});
  EXPECT_EQ(summary.end.outcome, RunOutcome::kCompleted) << summary.end.reason;
  ASSERT_GT(lasted_s.size(), 100U);
  EXPECT_TRUE(std::is_sorted(lasted_s.begin(), lasted_s.end()));
  EXPECT_NEAR(lasted_s.back(), 300.0, 5.0);
}

TEST(LostRecord, AnEndThatCannotBeRecordedIsWaitedForAndTold) {
  Rig rig;
  rig.engine.wait_for_record();
  const FullDisk disk(rig, "end_run", 1, 200.0);
  std::size_t told = 0;
  rig.engine.on_progress([&](const Progress& now) { told += now.waiting ? 1 : 0; });
  const auto summary = rig.summary_of({average()});
  EXPECT_EQ(summary.end.outcome, RunOutcome::kCompleted);
  EXPECT_GT(told, 100U);
  EXPECT_EQ(rig.log.ends.size(), 1U);
}

TEST(LostRecord, AnAbortIsTakenWhileItWaits) {
  Rig rig;
  rig.engine.wait_for_record();
  const FullDisk disk(rig, "point", 1, 1e9);
  rig.engine.on_progress([&](const Progress& now) {
    if (now.says.find("waiting for the run log") != std::string::npos) rig.engine.request_abort();
  });
  const auto summary = rig.run({compensate(), average(), sweep(Axis::kX, {0.0, 100.0})});
  ASSERT_FALSE(summary);
  EXPECT_LT(drivers::to_seconds(rig.plant.clock.now().time_since_epoch()), 60.0);
}

TEST(LostRecord, WhilePausedItIsWaitedForToo) {
  Rig rig;
  rig.engine.wait_for_record();
  bool paused = false;
  int ticks = 0;
  rig.log.fails = [&](const std::string&) { return paused && ticks > 5 && ticks < 20; };
  rig.engine.on_progress([&](const Progress& now) {
    if (now.state != RunState::kPaused) return;
    paused = true;
    if (++ticks == 40) rig.engine.request_resume();
  });
  rig.engine.request_pause();
  const auto summary = rig.summary_of({average(), average()});
  EXPECT_EQ(summary.end.outcome, RunOutcome::kCompleted) << summary.end.reason;
  EXPECT_GE(ticks, 40);
  EXPECT_EQ(rig.log.points.size(), 2U);
}

}  // namespace
}  // namespace fogbench::procedures
