// What to measure next: for the classical confusions the computed recommendation is the experiment
// that engineers know, and what cannot tell effects apart is never recommended.

#include "model/next/next_measurement.hpp"
#include "model/effects/catalogue.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "model/next/bench_schedule.hpp"
#include "model/next/separation.hpp"
#include "tests/model/models.hpp"

namespace fogbench::model {
namespace {

using testing::AnyOf;
using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::Field;
using testing::Ge;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;
using testing::UnorderedElementsAre;

/// A term that was found: its coefficients by column (one of its own is ""), its inner parameters.
config::ModelTerm found_term(std::string effect, std::map<std::string, double> coefficients,
                             std::map<std::string, double> parameters = {}) {
  config::ModelTerm out;
  out.effect = std::move(effect);
  out.parameters = std::move(parameters);
  if (const auto only = coefficients.find(""); only != coefficients.end()) {
    out.coefficient = only->second;
  } else {
    out.coefficients = std::move(coefficients);
  }
  return out;
}

/// A measurement, the model that was known, the effect that was found on top of it.
struct DiagnosedRun {
  Recorded present;
  std::vector<config::ModelTerm> known;
  config::ModelTerm found;
  double plain = 8.0;  ///< whitened size of the found effect, as when diagnoses are right
};

config::ModelFile fitted_model(const DiagnosedRun& c) {
  config::ModelFile model;
  model.terms = c.known;
  model.terms.push_back(c.found);
  config::ModelTerm& found = model.terms.back();
  const Effect* effect = find_effect(found.effect);
  std::vector<double> inner;
  for (const InnerParameter& p : effect->info().parameters) {
    inner.push_back(found.parameters.at(std::string(p.name)));
  }
  Truth truth;
  truth.beta.resize(static_cast<Eigen::Index>(effect->info().columns.size()));
  for (Eigen::Index i = 0; i < truth.beta.size(); ++i) {
    const std::string key(effect->info().columns[static_cast<std::size_t>(i)]);
    truth.beta[i] = found.coefficient ? *found.coefficient : found.coefficients.at(key);
  }
  const Separation separation(c.present, model, {effect}, {inner}, kNavigation, 1);
  const double scale = c.plain / std::sqrt(separation.squared(separation.present(), 0, truth));
  if (found.coefficient) *found.coefficient *= scale;
  for (auto& [key, value] : found.coefficients) value *= scale;
  return model;
}

std::vector<NextMeasurement> next_for(const DiagnosedRun& c, const std::vector<std::string>& set) {
  return next_measurements({c.present.table, fitted_model(c), kNavigation, {set}, {}});
}

testing::Matcher<const NextMeasurement&> action(const std::string& text) {
  return Field(&NextMeasurement::action, HasSubstr(text));
}

std::vector<double> levels() {
  std::vector<double> out;
  for (int i = 0; i <= 6; ++i) out.push_back(50.0 * i);
  for (int i = 5; i >= -6; --i) out.push_back(50.0 * i);
  for (int i = -5; i <= 0; ++i) out.push_back(50.0 * i);
  return out;
}

/// A sweep along OZ; with the thermostat at held_c where that is above the room.
Recorded sweep_z(double held_c = 21.0) {
  BenchSchedule bench(21.0);
  if (held_c > 21.0) {
    bench.heat(Heater::kNormal, held_c);
    bench.settle(0.0, "");
  }
  bench.wait(2400.0);
  bench.turn(90.0);
  bench.record(180.0, 180.0, "coil/baseline");
  bench.sweep('z', levels(), 180.0);
  return bench.recorded();
}

/// Averages at settled set points only; at the end one on the way down, where asked for.
Recorded plateaus(bool cooling) {
  BenchSchedule bench(21.0);
  bench.record(60.0, 60.0, "baseline");
  const auto plateau = [&](double target_c) {
    bench.heat(Heater::kNormal, target_c);
    bench.settle(0.0, "");
    bench.wait(600.0);
    bench.record(180.0, 60.0, "plateau");
  };
  for (const double target_c : {31.0, 35.0, 40.0, 45.0, 50.0, 55.0}) plateau(target_c);
  if (cooling) plateau(45.0);
  return bench.recorded();
}

/// One heating with the boost heaters.
Recorded ramp() {
  BenchSchedule bench(21.0);
  bench.heat(Heater::kBoost, 50.0);
  bench.record(3600.0, 60.0, "heating");
  return bench.recorded();
}

/// A quarter of an hour at azimuth 0, another one at 90 deg.
Recorded rotation() {
  BenchSchedule bench(21.0);
  bench.wait(2400.0);
  bench.record(900.0, 180.0, "static");
  bench.turn(90.0);
  bench.record(900.0, 180.0, "static");
  return bench.recorded();
}

std::vector<config::ModelTerm> magnetic() {
  return {term("bias"), term("magnetic_linear_z")};
}
std::vector<config::ModelTerm> thermal() {
  return {term("bias"), term("temperature_linear"), term("temperature_quadratic")};
}

TEST(NextMeasurement, FurtherAzimuthsTellTheEarthFromAStep) {
  const DiagnosedRun earth{rotation(),
                           {term("bias")},
                           found_term("earth_rate_projection", {{"cos", -0.01}, {"sin", 0.002}})};
  const DiagnosedRun step{
      rotation(), {term("bias")}, found_term("bias_step", {{"", 0.01}}, {{"t0", 3330.0}})};
  for (const auto& next : {next_for(earth, {"earth_rate_projection", "bias_step"}),
                           next_for(step, {"bias_step", "earth_rate_projection"})}) {
    ASSERT_THAT(next, Not(IsEmpty()));
    EXPECT_THAT(next.front(), action("further azimuths"));
    // The jump may fall on the rotation again: the same run once more shows the same picture.
    EXPECT_THAT(next.front(), action("repeating the present run would not"));
    for (const NextMeasurement& n : next) EXPECT_THAT(n, Not(action("repeat the present run:")));
  }
}

TEST(NextMeasurement, LongHoldsTellCoilHeatingFromAQuadraticTerm) {
  const DiagnosedRun heating{sweep_z(), magnetic(),
                             found_term("coil_heating", {{"", 0.003}}, {{"tau", 400.0}})};
  const DiagnosedRun quadratic{sweep_z(), magnetic(),
                               found_term("magnetic_quadratic_z", {{"", 0.002}})};
  for (const auto& next : {next_for(heating, {"coil_heating", "magnetic_quadratic_z"}),
                           next_for(quadratic, {"magnetic_quadratic_z", "coil_heating"})}) {
    ASSERT_THAT(next, Not(IsEmpty()));
    EXPECT_THAT(next.front().action, AnyOf(HasSubstr("stay ten minutes at each level"),
                                           HasSubstr("hold +300 and -300 uT along OZ")));
  }
}

TEST(NextMeasurement, BoostAgainstNormalHeatingTellsTheGradientFromTheRate) {
  const DiagnosedRun gradient{ramp(), thermal(), found_term("temperature_gradient", {{"", 0.05}})};
  const auto next = next_for(gradient, {"temperature_gradient", "temperature_rate"});
  ASSERT_THAT(next, Not(IsEmpty()));
  EXPECT_THAT(next.front(), action("the boost heaters and the normal one"));
  EXPECT_THAT(next.front(), action("repeating the present run would not"));
}

TEST(NextMeasurement, CoolingIsAmongWhatTellsThermalHysteresisFromWarmUp) {
  const DiagnosedRun hysteresis{
      plateaus(true), thermal(),
      found_term("temperature_hysteresis", {{"", 0.005}}, {{"width", 3.0}})};
  const auto next = next_for(hysteresis, {"temperature_hysteresis", "warm_up"});
  EXPECT_THAT(next, Contains(action("let it cool")));
  // Heating alone would put the verdict on the state that the hysteresis happens to start from.
  EXPECT_THAT(next, Each(Not(action("edges"))));
}

TEST(NextMeasurement, ManyWindowsInOnePointTellSettlingFromHysteresis) {
  const DiagnosedRun hysteresis{
      sweep_z(), magnetic(), found_term("magnetic_hysteresis_z", {{"", 0.02}}, {{"width", 0.3}})};
  const DiagnosedRun settling{sweep_z(), magnetic(),
                              found_term("magnetic_settling_z", {{"", 0.05}}, {{"tau", 60.0}})};
  for (const auto& next : {next_for(hysteresis, {"magnetic_hysteresis_z", "magnetic_settling_z"}),
                           next_for(settling, {"magnetic_settling_z", "magnetic_hysteresis_z"})}) {
    ASSERT_THAT(next, Not(IsEmpty()));
    EXPECT_THAT(next.front().action,
                AnyOf(HasSubstr("in windows of 30 s"), HasSubstr("two windows in each point")));
    EXPECT_THAT(next.front(), action("repeating the present run would not"));
  }
}

TEST(NextMeasurement, HoursAtRestTellASlowEffectFromARandomWalk) {
  const DiagnosedRun drift{sweep_z(), magnetic(), found_term("drift_linear", {{"", 0.02}})};
  const auto next = next_for(drift, {"drift_linear", "random_walk"});
  EXPECT_THAT(next, Contains(action("4 h at rest")));
  EXPECT_THAT(next, Contains(action("--quiet")));
  // A walk does not repeat, so that here repeating helps.
  EXPECT_THAT(next.front(), action("more of the present run"));
}

TEST(NextMeasurement, AColdStartShowsWarmUpAgain) {
  const DiagnosedRun warm_up{sweep_z(), magnetic(),
                             found_term("warm_up", {{"", 0.1}}, {{"tau", 3000.0}})};
  const auto next = next_for(warm_up, {"warm_up", "random_walk"});
  ASSERT_THAT(next, Not(IsEmpty()));
  EXPECT_THAT(next.front(), action("start cold and record from power-on"));
}

TEST(NextMeasurement, LongRecordsTellADriftFromTheTailOfWarmUp) {
  const DiagnosedRun drift{sweep_z(), magnetic(), found_term("drift_linear", {{"", 0.02}})};
  const auto next = next_for(drift, {"drift_linear", "warm_up"});
  ASSERT_THAT(next, Not(IsEmpty()));
  EXPECT_THAT(next.front(), action("4 h at rest"));
}

TEST(NextMeasurement, SwitchingTheHeaterTellsItFromTheTemperature) {
  const DiagnosedRun heater{
      plateaus(false), {term("bias")}, found_term("heater_power", {{"", 0.02}})};
  const auto next = next_for(heater, {"heater_power", "temperature_linear"});
  EXPECT_THAT(next, Contains(action("switch the heater off for 60 s")));
}

TEST(NextMeasurement, PassingThroughAllTemperaturesTellsARippleFromAPolynomial) {
  const DiagnosedRun ripple{
      plateaus(false), thermal(),
      found_term("temperature_ripple", {{"sin", 0.01}, {"cos", 0.01}}, {{"period", 8.0}})};
  const auto next = next_for(ripple, {"temperature_ripple", "temperature_cubic"});
  ASSERT_THAT(next, Not(IsEmpty()));
  EXPECT_THAT(next.front().action, AnyOf(HasSubstr("heat in one go"), HasSubstr("by 1 degC"),
                                         HasSubstr("edges"), HasSubstr("(thermostat-steps)")));
  EXPECT_THAT(next, Each(Not(action("repeat the present run"))));
}

TEST(NextMeasurement, ASecondTemperatureTellsTheTemperatureDependenceOfASlope) {
  const DiagnosedRun linear{
      sweep_z(45.0), {term("bias")}, found_term("magnetic_linear_z", {{"", 0.02}}), 20.0};
  const auto next = next_for(linear, {"magnetic_linear_z", "magnetic_temperature_z"});
  ASSERT_THAT(next, Not(IsEmpty()));
  EXPECT_THAT(next.front(), action("second thermostat temperature, 31 degC"));
}

TEST(NextMeasurement, WhatIsRecommendedIsExpectedToSucceed) {
  const DiagnosedRun settling{sweep_z(), magnetic(),
                              found_term("magnetic_settling_z", {{"", 0.05}}, {{"tau", 60.0}})};
  const auto next = next_for(settling, {"magnetic_settling_z", "magnetic_hysteresis_z"});
  EXPECT_THAT(next, SizeIs(testing::Le(2u)));
  EXPECT_THAT(next, Each(Field(&NextMeasurement::separation, Ge(3.6))));
  EXPECT_THAT(next, Each(Field(&NextMeasurement::hours, Ge(0.5))));
  EXPECT_THAT(next, Each(Field(&NextMeasurement::tells_apart,
                               ElementsAre("magnetic_settling_z", "magnetic_hysteresis_z"))));
}

TEST(NextMeasurement, NothingIsRecommendedForAnEffectFarBelowTheNoise) {
  const DiagnosedRun faint{sweep_z(), magnetic(),
                           found_term("magnetic_settling_z", {{"", 0.05}}, {{"tau", 60.0}}), 0.05};
  const auto next = next_for(faint, {"magnetic_settling_z", "magnetic_hysteresis_z"});
  ASSERT_THAT(next, SizeIs(1));
  EXPECT_THAT(next.front(), action("none of the"));
  EXPECT_EQ(next.front().separation, 0.0);
}

TEST(NextMeasurement, RepeatsWhereThePresentRunShouldHaveDone) {
  // Over a day a walk hides the drift's slope, and a jump stands out of both.
  BenchSchedule bench(21.0);
  bench.record(24.0 * 3600.0, 600.0, "static");
  const DiagnosedRun drift{
      bench.recorded(), {term("bias")}, found_term("drift_linear", {{"", 0.01}})};
  const auto next = next_for(drift, {"drift_linear", "bias_step"});
  ASSERT_THAT(next, Not(IsEmpty()));
  EXPECT_THAT(next.front(), action("repeat the present run"));
  EXPECT_THAT(next, Each(Not(action("none of the"))));
}

TEST(NextMeasurement, ThreeMembersAreToldApartPairByPairWhereNoExperimentServesAll) {
  const DiagnosedRun hysteresis{
      sweep_z(), magnetic(), found_term("magnetic_hysteresis_z", {{"", 0.02}}, {{"width", 0.3}})};
  const auto next =
      next_for(hysteresis, {"magnetic_hysteresis_z", "magnetic_settling_z", "drift_linear"});
  ASSERT_THAT(next, Not(IsEmpty()));
  std::set<std::string> told;
  for (const NextMeasurement& n : next) told.insert(n.tells_apart.begin(), n.tells_apart.end());
  EXPECT_THAT(told,
              UnorderedElementsAre("magnetic_hysteresis_z", "magnetic_settling_z", "drift_linear"));
  EXPECT_THAT(next, Each(Field(&NextMeasurement::separation, Ge(3.6))));
}

TEST(NextMeasurement, ASetThatTheCatalogueCannotEvaluateGetsNoAdvice) {
  const DiagnosedRun found{sweep_z(), magnetic(), found_term("drift_linear", {{"", 0.02}})};
  EXPECT_THAT(next_for(found, {"my_own_term", "drift_linear"}), IsEmpty());
  EXPECT_THAT(next_for(found, {"drift_linear", "my_own_term"}), IsEmpty());
}

TEST(NextMeasurement, OneExperimentServesAllEffectsThatItShows) {
  config::ModelFile model;
  model.terms = magnetic();
  const std::vector<NotTestable> unseen = {{"temperature_linear", ""},
                                           {"temperature_rate", ""},
                                           {"temperature_hysteresis", ""},
                                           {"magnetic_cross_xy", ""}};
  const Recorded present = sweep_z();
  const auto next = next_measurements({present.table, model, kNavigation, {}, unseen});
  const auto shows = [](const auto& effects) {
    return Field(&NextMeasurement::tells_apart, effects);
  };
  EXPECT_THAT(next, Contains(shows(Contains("temperature_linear"))).Times(1));
  EXPECT_THAT(next, Contains(testing::AllOf(shows(Contains("temperature_linear")),
                                            shows(Contains("temperature_rate")))));
  EXPECT_THAT(next,
              Contains(testing::AllOf(shows(Contains("temperature_hysteresis")), action("cool"))));
  EXPECT_THAT(next, Contains(testing::AllOf(shows(ElementsAre("magnetic_cross_xy")),
                                            action("energise OX and OY together"))));
}

TEST(NextMeasurement, NamesTheColumnsThatNobodyRecorded) {
  Table table;
  const Recorded ramped = ramp();
  for (const char* name : {"time_s", "duration_s", "temperature_c"}) {
    const auto values = ramped.table.column(name);
    table.set_column(name, {values.begin(), values.end()});
  }
  config::ModelFile model;
  model.terms = thermal();
  const std::vector<NotTestable> unseen = {
      {"magnetic_linear_x", ""}, {"magnetic_cross_xy", ""}, {"ambient_temperature", ""}};
  const auto next = next_measurements({table, model, kNavigation, {}, unseen});
  ASSERT_THAT(next, SizeIs(2));
  EXPECT_THAT(next[0], action("record field_x_ut, field_y_ut"));
  EXPECT_THAT(next[0].tells_apart, UnorderedElementsAre("magnetic_linear_x", "magnetic_cross_xy"));
  EXPECT_THAT(next[1], action("record ambient_c"));
}

TEST(NextMeasurement, WorksWithoutTimesAndWithoutNoise) {
  Table table;
  table.set_column("temperature_c", {21, 31, 35, 40, 45, 50, 55, 45, 35});
  config::ModelFile model;
  model.terms = thermal();
  const std::vector<NotTestable> unseen = {{"temperature_ripple", ""}, {"warm_up", ""}};
  const auto next = next_measurements({table, model, {}, {}, unseen});
  EXPECT_THAT(next, Contains(action("record time_s")));
  EXPECT_THAT(next,
              Contains(Field(&NextMeasurement::tells_apart, ElementsAre("temperature_ripple"))));
}

TEST(BenchExperiments, StayWithinWhatTheBenchReaches) {
  BenchState state;
  state.moving_axes = "xyz";
  state.reach = {.field_ut = 200.0, .warmest_c = 48.0};
  const auto experiments = bench_experiments(state);
  EXPECT_GT(experiments.size(), 30U);
  for (const Experiment& e : experiments) {
    const Table& table = e.record.table;
    for (const char* axis : {"field_x_ut", "field_y_ut", "field_z_ut"}) {
      if (!table.has(axis)) continue;
      for (const double field : table.column(axis)) EXPECT_LE(std::abs(field), 200.0) << e.key;
    }
    for (const double t : table.column("temperature_c")) EXPECT_LE(t, 48.5) << e.key;
    for (const char* beyond :
         {"300 uT", "levels_ut 300", "levels_ut 0, 50, 100, 50", "55 degC", "50, 55", " 52"}) {
      EXPECT_EQ(e.action.find(beyond), std::string::npos) << e.action;
    }
  }
  state.reach = {.field_ut = 0.0, .warmest_c = 40.0};
  for (const Experiment& e : bench_experiments(state)) {
    EXPECT_FALSE(e.about.field || e.about.temperature) << e.action;
  }
}

TEST(BenchExperiments, TakeTheReachFromLimitsAndSupplies) {
  config::BenchConfig bench;
  EXPECT_EQ(reach_of(bench).field_ut, 300.0) << "4 A and 89.9 uT/A, 55 uT to be nulled";
  EXPECT_EQ(reach_of(bench).warmest_c, 55.0);
  bench.limits.field_maximum = config::Microtesla{220.0};
  bench.limits.temperature_maximum = config::Celsius{50.0};
  EXPECT_EQ(reach_of(bench).field_ut, 200.0);
  EXPECT_EQ(reach_of(bench).warmest_c, 50.0);
  bench.coil_vertical.current_limit = config::Ampere{2.0};
  EXPECT_EQ(reach_of(bench).field_ut, 100.0);
  bench.coil_vertical.current_limit = config::Ampere{0.5};
  EXPECT_EQ(reach_of(bench).field_ut, 0.0);
}

}  // namespace
}  // namespace fogbench::model
