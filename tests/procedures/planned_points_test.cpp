#include "procedures/planned_points.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/procedures/engine_fixture.hpp"

namespace fogbench::procedures {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

TEST(PlannedPoints, AveragesFitIntoAWaitAsOftenAsTheyEndWithinIt) {
  EXPECT_EQ(windows_in(Seconds{30.0}, Seconds{30.0}), 1U);
  EXPECT_EQ(windows_in(Seconds{0.3}, Seconds{0.1}), 3U) << "though not in floating point";
  EXPECT_EQ(windows_in(Seconds{59.0}, Seconds{60.0}), 0U);
  EXPECT_EQ(windows_in(Seconds{-1.0}, Seconds{60.0}), 0U);
}

TEST(PlannedPoints, AreThoseOfAveragesSweepsAndWaits) {
  const Plan plan = Rig().plan({compensate(), average(), sweep(Axis::kX, {0.0, 100.0, 0.0}),
                                step(config::Wait{120.0, 0.0, "static", 60.0}), wait(600.0)});
  EXPECT_EQ(planned_points(plan), 1U + 3U + 2U);
  EXPECT_TRUE(measures(plan));
  EXPECT_THAT(plan.steps[5].says, testing::HasSubstr(": 2 points"));
}

TEST(PlannedPoints, WhatSettlingRecordsIsMeasuredThoughNobodyKnowsHowMuch) {
  const Plan plan = Rig().plan({heat(31.0), settle(600.0, "thermostat/heating")});
  EXPECT_EQ(planned_points(plan), 0U);
  EXPECT_TRUE(measures(plan));
  EXPECT_FALSE(measures(Rig().plan({heat(31.0), settle(), wait(30.0)})));
}

}  // namespace
}  // namespace fogbench::procedures
