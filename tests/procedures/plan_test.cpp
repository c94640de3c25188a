#include "procedures/plan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "procedures/check_limits.hpp"
#include "procedures/expand.hpp"
#include "procedures/phases.hpp"
#include "procedures/planned_points.hpp"
#include "procedures/sentence.hpp"
#include "tests/procedures/procedure_builder.hpp"

namespace fogbench::procedures {
namespace {

using test::procedure;
using test::step;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

Result<Plan> plan_of(std::vector<config::Step> steps, const config::BenchConfig& bench = {}) {
  const auto expanded =
      expand(procedure("p", std::move(steps)), {},
             [](const std::string& name, const config::ProcedureConfig&) {
               return Result<config::ProcedureConfig>(Error{ErrorCode::kBadInput, name});
             });
  EXPECT_TRUE(expanded);
  return make_plan("p", *expanded, bench);
}

std::string refusal(std::vector<config::Step> steps, ErrorCode code,
                    const config::BenchConfig& bench = {}) {
  const auto plan = plan_of(std::move(steps), bench);
  if (plan) return "accepted";
  EXPECT_EQ(plan.error().code, code);
  return plan.error().message;
}

config::Step swept(Axis axis, std::vector<double> levels) {
  return step(config::Sweep{axis, std::move(levels), 180.0, 5.0, "coil"});
}
config::Step heat_to(double target_c) {
  return step(config::SetTemperature{target_c, HeatingMode::kNormal});
}

TEST(Plan, SaysEachStepInASentenceWithUnits) {
  const auto plan = plan_of({step(config::CompensateField{0.2}), swept(Axis::kX, {0.0, 50.0}),
                             heat_to(31.0), step(config::Baseline{60.0, "t/baseline"})});
  ASSERT_TRUE(plan) << plan.error().message;
  EXPECT_EQ(plan->steps[2].says,
            "set 50 uT along OX, settle for 5 s, average for 3 min as coil/up");
  EXPECT_EQ(plan->steps[3].says, "hold 31 degC in normal mode");
  EXPECT_EQ(plan->steps[4].says, "measure the baseline for 1 min as t/baseline");
}

TEST(Plan, RefusesATemperatureOutsideTheBenchOrItsThermostat) {
  EXPECT_THAT(refusal({heat_to(61.0)}, ErrorCode::kLimit),
              AllOf(HasSubstr("p.json: /steps/0"), HasSubstr("61 degC"), HasSubstr("15 to 60")));
  EXPECT_THAT(refusal({heat_to(14.0)}, ErrorCode::kLimit), HasSubstr("14 degC"));
  config::BenchConfig bench;
  bench.thermostat.device.target_minimum = Celsius{20.0};
  bench.thermostat.device.target_maximum = Celsius{50.0};
  EXPECT_THAT(refusal({heat_to(55.0)}, ErrorCode::kLimit, bench), HasSubstr("20 to 50"));
}

TEST(Plan, RefusesAFieldOrACurrentOutsideTheBench) {
  const auto zeroed = step(config::CompensateField{0.2});
  EXPECT_THAT(refusal({zeroed, swept(Axis::kX, {0.0, -330.0})}, ErrorCode::kLimit),
              AllOf(HasSubstr("p.json: /steps/1"), HasSubstr("-330 uT"), HasSubstr("320 uT")));
  config::BenchConfig weak;
  weak.coil_vertical.current_limit = config::Ampere{3.5};
  EXPECT_THAT(refusal({zeroed, swept(Axis::kY, {0.0, 300.0})}, ErrorCode::kLimit, weak),
              AllOf(HasSubstr("3.95 A"), HasSubstr("3.50 A")));
  config::BenchConfig weak_supply;
  weak_supply.coil_horizontal.device.minimum = -3.0;
  weak_supply.coil_horizontal.device.maximum = 3.0;
  EXPECT_THAT(refusal({zeroed, swept(Axis::kX, {0.0, 300.0})}, ErrorCode::kLimit, weak_supply),
              HasSubstr("3.00 A"));
}

TEST(Plan, RefusesARunLongerThanTheBenchAllows) {
  EXPECT_THAT(refusal({step(config::Wait{172801.0, 0.0, "", 60.0})}, ErrorCode::kLimit),
              AllOf(HasSubstr("48 h 1 s"), HasSubstr("48 h")));
}

TEST(Plan, RefusesASweepWithoutAZeroOrAwayFromItsCoil) {
  const auto zeroed = step(config::CompensateField{0.2});
  const auto turned = step(config::Rotate{90.0});
  EXPECT_THAT(refusal({swept(Axis::kX, {0.0})}, ErrorCode::kBadInput),
              HasSubstr("without compensate_field"));
  EXPECT_THAT(refusal({zeroed, turned, swept(Axis::kZ, {0.0})}, ErrorCode::kBadInput),
              HasSubstr("without compensate_field"));
  EXPECT_THAT(refusal({zeroed, swept(Axis::kZ, {0.0})}, ErrorCode::kBadInput),
              AllOf(HasSubstr("OZ at azimuth 0 deg"), HasSubstr("rotate to 90")));
  EXPECT_TRUE(plan_of({turned, zeroed, swept(Axis::kZ, {0.0})}));
}

TEST(Plan, DrivesNorthAtAnyAzimuthAndHoldsTheOtherPairWithinItsLimit) {
  const auto zeroed = step(config::CompensateField{0.2});
  const auto turned = step(config::Rotate{45.0});
  EXPECT_THAT(refusal({turned, zeroed, swept(Axis::kY, {0.0})}, ErrorCode::kBadInput),
              HasSubstr("OY at azimuth 45 deg"));
  config::Sweep north{Axis::kNorth, std::vector<double>{100.0}, 180.0, 5.0, "coil", 200.0};
  const auto plan = plan_of({turned, zeroed, step(north)});
  ASSERT_TRUE(plan) << plan.error().message;
  EXPECT_THAT(plan->steps.back().says, HasSubstr("100 uT along north and 200 uT along OX"));
  config::BenchConfig weak;
  weak.coil_horizontal.current_limit = config::Ampere{2.0};
  EXPECT_THAT(refusal({turned, zeroed, step(north)}, ErrorCode::kLimit, weak),
              HasSubstr("a level of 200 uT"));
}

TEST(Plan, SaysWhichLimitsAreMetAndByHowMuch) {
  const auto plan = plan_of({heat_to(31.0), heat_to(55.0), step(config::CompensateField{0.2}),
                             swept(Axis::kX, {0.0, 300.0, -300.0})});
  ASSERT_TRUE(plan) << plan.error().message;
  EXPECT_THAT(plan->limits_met, Contains(HasSubstr("31 to 55 degC, allowed 15 to 60")));
  EXPECT_THAT(plan->limits_met, Contains(HasSubstr("-300 to 300 uT, allowed up to 320")));
  EXPECT_THAT(plan->limits_met, Contains(HasSubstr("at most 3.95 A")));
  EXPECT_THAT(plan->limits_met, Contains(HasSubstr("allowed 48 h")));
}

TEST(Plan, EstimatesWhatTheStepsTake) {
  config::BenchConfig bench;
  bench.estimates.room = Celsius{21.0};
  bench.estimates.heating = config::CelsiusPerHour{30.0};
  bench.estimates.settling = Seconds{900.0};
  bench.turntable.motorised = true;
  bench.turntable.move_time = Seconds{20.0};
  bench.coil_horizontal.device.settle = Seconds{0.5};
  const auto plan = plan_of(
      {heat_to(31.0), step(config::SettleTemperature{1.0, 300.0, 1.0, 7200.0, "", 60.0}),
       step(config::Wait{0.0, 3000.0, "", 60.0}), step(config::Average{60.0, ""}),
       step(config::CompensateField{0.2}), swept(Axis::kX, {0.0}), step(config::Rotate{90.0})},
      bench);
  ASSERT_TRUE(plan) << plan.error().message;
  const auto estimate = [&](std::size_t i) { return plan->steps[i].estimate.count(); };
  EXPECT_DOUBLE_EQ(estimate(1), 9.0 / 30.0 * 3600.0 + 900.0 + 300.0);
  EXPECT_DOUBLE_EQ(estimate(2), 3000.0 - estimate(1));
  EXPECT_DOUBLE_EQ(estimate(3), 60.0);
  EXPECT_DOUBLE_EQ(estimate(4), 15.0);
  EXPECT_DOUBLE_EQ(estimate(5), 185.5);
  EXPECT_DOUBLE_EQ(estimate(6), 20.0);
  EXPECT_DOUBLE_EQ(plan->estimate.count(), 3000.0 + 60.0 + 15.0 + 185.5 + 20.0);
}

TEST(Plan, ASettleIsEstimatedAtNoMoreThanItsTimeout) {
  const auto plan =
      plan_of({heat_to(55.0), step(config::SettleTemperature{1.0, 300.0, 1.0, 600.0, "", 60.0})});
  ASSERT_TRUE(plan) << plan.error().message;
  EXPECT_DOUBLE_EQ(plan->estimate.count(), 600.0);
}

TEST(DurationText, HasNoMoreUnitsThanNeeded) {
  EXPECT_EQ(duration_text(Seconds{0.5}), "0.5 s");
  EXPECT_EQ(duration_text(Seconds{60.0}), "1 min");
  EXPECT_EQ(duration_text(Seconds{3665.0}), "1 h 1 min 5 s");
  EXPECT_EQ(duration_text(Seconds{1e300}), "1e+300 s");
}

/// As the simulated bench: 12 W and 9 W into 830 J/K, which lose 0.22 W/K.
config::BenchConfig bench_of_known_reach() {
  config::BenchConfig bench;
  bench.thermal = config::reach_of(config::ThermalPlant{});
  return bench;
}

config::Step ramp_to(double to_c, double rate_c_per_h) {
  return step(config::Ramp{to_c, rate_c_per_h, HeatingMode::kBoost, false, "ramp", 60.0});
}

TEST(Plan, RefusesATemperatureThatHeatersAndRoomCannotHold) {
  const config::BenchConfig bench = bench_of_known_reach();
  EXPECT_THAT(refusal({heat_to(20.0)}, ErrorCode::kLimit, bench),
              AllOf(HasSubstr("p.json: /steps/0: target_c is 20 degC in a room of 21 degC"),
                    HasSubstr("nothing that cools")));
  config::BenchConfig weak = bench;
  weak.thermal->normal = CelsiusPerHour{20.0};
  EXPECT_THAT(refusal({heat_to(50.0)}, ErrorCode::kLimit, weak),
              HasSubstr("the bench's normal heater holds 42.0 degC at most"));
  config::BenchConfig cooled = bench;
  cooled.thermal->cooling = CelsiusPerHour{4.0};
  EXPECT_TRUE(plan_of({heat_to(20.0)}, cooled));
  EXPECT_THAT(refusal({heat_to(16.0)}, ErrorCode::kLimit, cooled), HasSubstr("comes down to 16.8"));
  EXPECT_TRUE(plan_of({heat_to(20.0)})) << "nobody has said what that bench can";
}

TEST(Plan, RefusesARampThatHeatersOrRoomCannotFollowAndNamesTheNearest) {
  const config::BenchConfig bench = bench_of_known_reach();
  // 52.05 - 34/1.048 = 19.6 degC/h are left at 55 degC.
  EXPECT_THAT(refusal({ramp_to(55.0, 30.0)}, ErrorCode::kLimit, bench),
              AllOf(HasSubstr("/steps/0: a ramp from 21 to 55 degC at 30 degC/h"),
                    HasSubstr("as far as 44.1 degC"), HasSubstr("goes all the way is 19 degC/h")));
  EXPECT_TRUE(plan_of({ramp_to(55.0, 19.0)}, bench));
  EXPECT_THAT(refusal({ramp_to(55.0, 120.0)}, ErrorCode::kLimit, bench),
              HasSubstr("cannot follow at all"));
  EXPECT_THAT(refusal({ramp_to(50.0, 20.0), ramp_to(25.0, 20.0)}, ErrorCode::kLimit, bench),
              AllOf(HasSubstr("/steps/1: a ramp from 50 to 25 degC"), HasSubstr("without a cooler"),
                    HasSubstr("as far as 42.0 degC"), HasSubstr("goes all the way is 3.8 degC/h")));
  const auto unknown = plan_of({ramp_to(55.0, 120.0)});
  ASSERT_TRUE(unknown);
  EXPECT_THAT(unknown->limits_met, Contains(HasSubstr("has no \"thermal\"")));
}

TEST(Plan, ARampTakesWhatItsRateSaysAndGivesItsPoints) {
  const auto plan = plan_of({ramp_to(31.0, 20.0), ramp_to(27.0, 5.0)}, bench_of_known_reach());
  ASSERT_TRUE(plan) << plan.error().message;
  EXPECT_DOUBLE_EQ(plan->steps[0].estimate.count(), 1800.0);
  EXPECT_DOUBLE_EQ(plan->steps[1].estimate.count(), 2880.0);
  EXPECT_EQ(plan->steps[0].says,
            "ramp to 31 degC at 20 degC/h, recording averages of 1 min as ramp");
  EXPECT_EQ(planned_points(*plan), 30U + 48U);
  EXPECT_THAT(plan->limits_met,
              Contains(HasSubstr("ramps up: 20 degC/h, the bench can 42.5 degC/h at 31")));
}

TEST(Plan, PhasesSayWhatHowLongAndHowManyPoints) {
  const auto plan = plan_of(
      {step(config::CompensateField{0.2}), swept(Axis::kX, {0.0, 50.0, 0.0}),
       step(config::Repeat{
           2.0, {ramp_to(31.0, 20.0), step(config::Wait{600.0, 0.0, "cycle/high", 60.0})}})});
  ASSERT_TRUE(plan) << plan.error().message;
  const auto phases = phases_of(*plan);
  ASSERT_EQ(phases.size(), 4U);
  EXPECT_EQ(phases[1].says, "sweep along OX: 3 levels, 0 to 50 uT, 3 min each as coil");
  EXPECT_EQ(phases[1].points, 3U);
  EXPECT_EQ(phases[2].says, "turn 1 of 2: ramp, cycle/high");
  EXPECT_EQ(phases[2].points, 30U + 10U);
  EXPECT_DOUBLE_EQ(phases[2].estimate.count(), 2400.0);
  EXPECT_DOUBLE_EQ(phases[3].starts_after.count(),
                   phases[2].starts_after.count() + phases[2].estimate.count());
  EXPECT_EQ(phases[3].says, "turn 2 of 2: ramp, cycle/high");
}

TEST(Plan, EverythingThatKeepsItFromABenchIsSaidAtOnce) {
  const auto problems =
      check_procedure(procedure("p", {heat_to(20.0), heat_to(70.0), swept(Axis::kX, {0.0, 400.0}),
                                      step(config::Average{"$absent", ""})}),
                      bench_of_known_reach());
  std::string said;
  for (const Error& problem : problems) said += problem.message + "\n";
  for (const char* what : {"/steps/0: target_c is 20", "/steps/1: target_c is 70",
                           "/steps/2: a sweep without", "/steps/3: no parameter"}) {
    EXPECT_THAT(said, HasSubstr(what));
  }
}

}  // namespace
}  // namespace fogbench::procedures
