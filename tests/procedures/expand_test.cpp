#include "procedures/expand.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "procedures/branches.hpp"
#include "tests/procedures/procedure_builder.hpp"

namespace fogbench::procedures {
namespace {

using config::ProcedureConfig;
using test::procedure;
using test::step;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

Result<ProcedureConfig> no_other(const std::string& name, const ProcedureConfig&) {
  return Error{ErrorCode::kBadInput, name + ": no such file"};
}

std::string error_of(const ProcedureConfig& p, const Parameters& overrides = {},
                     const ProcedureLoader& loader = no_other) {
  const auto steps = expand(p, overrides, loader);
  if (steps) return "no error";
  EXPECT_EQ(steps.error().code, ErrorCode::kBadInput);
  EXPECT_EQ(steps.error().message.find('\n'), std::string::npos);
  return steps.error().message;
}

TEST(Expand, BindsParametersAndOverrides) {
  ProcedureConfig p = procedure(
      "p", {step(config::Average{"$duration_s", "a"}), step(config::Average{"$other_s", "b"})});
  p.parameters = {{"duration_s", 60.0}, {"other_s", 5.0}};
  const auto steps = expand(p, {{"duration_s", 180.0}}, no_other);
  ASSERT_TRUE(steps) << steps.error().message;
  EXPECT_EQ(std::get<Average>((*steps)[0].action).duration, Seconds{180.0});
  EXPECT_EQ(std::get<Average>((*steps)[1].action).duration, Seconds{5.0});
}

TEST(Expand, TakesOneNumberForAListOfOne) {
  ProcedureConfig p = procedure(
      "p",
      {step(config::ForEach{
          "t_c", "$targets_c", {step(config::SetTemperature{"$t_c", HeatingMode::kNormal})}})});
  p.parameters = {{"targets_c", std::vector<double>{31.0, 35.0}}};
  const auto steps = expand(p, {{"targets_c", 40.0}}, no_other);
  ASSERT_TRUE(steps) << steps.error().message;
  ASSERT_EQ(steps->size(), 1U);
  EXPECT_EQ(std::get<SetTemperature>((*steps)[0].action).target, Celsius{40.0});
}

TEST(Expand, UnrollsLoopsInOrderAndNumbersTheirTurns) {
  ProcedureConfig p = procedure(
      "p", {step(config::Prompt{"first"}),
            step(config::ForEach{"t_c",
                                 std::vector<double>{31.0, 35.0},
                                 {step(config::SetTemperature{"$t_c", HeatingMode::kBoost}),
                                  step(config::Average{60.0, "a"})}})});
  const auto steps = expand(p, {}, no_other);
  ASSERT_TRUE(steps) << steps.error().message;
  std::vector<std::string> paths;
  for (const auto& s : *steps) paths.push_back(s.path);
  EXPECT_THAT(paths, ElementsAre("1", "2.1.1", "2.1.2", "2.2.1", "2.2.2"));
  EXPECT_EQ(std::get<SetTemperature>((*steps)[3].action).target, Celsius{35.0});
}

TEST(Expand, AnEmptyLoopIsNoSteps) {
  const auto steps = expand(
      procedure("p",
                {step(config::ForEach{"t_c", std::vector<double>{}, {step(config::Prompt{"x"})}})}),
      {}, no_other);
  ASSERT_TRUE(steps) << steps.error().message;
  EXPECT_TRUE(steps->empty());
}

TEST(Expand, AWaitForNothingIsLeftOut) {
  ProcedureConfig p = procedure("p", {step(config::Wait{0.0, "$warm_up_s", "", 60.0})});
  p.parameters = {{"warm_up_s", 0.0}};
  const auto none = expand(p, {}, no_other);
  ASSERT_TRUE(none) << none.error().message;
  EXPECT_TRUE(none->empty());
  const auto one = expand(p, {{"warm_up_s", 60.0}}, no_other);
  ASSERT_TRUE(one) << one.error().message;
  EXPECT_EQ(one->size(), 1U);
}

TEST(Expand, ASweepIsABlockOfItsLevelsWithBranches) {
  const auto steps = expand(
      procedure("p", {step(config::Sweep{Axis::kY, test::paper_levels(), 180.0, 5.0, "coil_y"}),
                      step(config::Average{60.0, "after"}),
                      step(config::Sweep{Axis::kX, std::vector<double>{0.0, 50.0}, 1.0, 0.0, ""})}),
      {}, no_other);
  ASSERT_TRUE(steps) << steps.error().message;
  ASSERT_EQ(steps->size(), 25U + 1U + 2U);
  const auto level = [&](std::size_t i) { return std::get<SweepLevel>((*steps)[i].action); };
  EXPECT_EQ(level(0).segment, "coil_y/up");
  EXPECT_EQ(level(6).level, Microtesla{300.0});
  EXPECT_EQ(level(6).segment, "coil_y/up");
  EXPECT_EQ(level(7).segment, "coil_y/down");
  EXPECT_EQ(level(18).level, Microtesla{-300.0});
  EXPECT_EQ(level(18).segment, "coil_y/down");
  EXPECT_EQ(level(19).segment, "coil_y/return");
  EXPECT_EQ(level(24).segment, "coil_y/return");
  EXPECT_EQ((*steps)[0].block, 1);
  EXPECT_EQ((*steps)[24].block, 1);
  EXPECT_EQ((*steps)[25].block, 0);
  EXPECT_EQ((*steps)[26].block, 2);
  EXPECT_EQ(level(27).segment, "up");
}

TEST(Expand, AnIndivisiblePartTakesItsSweepsIn) {
  const auto steps =
      expand(procedure("p", {step(config::Indivisible{
                                {step(config::CompensateField{0.2}),
                                 step(config::Sweep{Axis::kX, std::vector<double>{0.0, 50.0}, 1.0,
                                                    0.0, "coil_x"})}})}),
             {}, no_other);
  ASSERT_TRUE(steps) << steps.error().message;
  for (const auto& s : *steps) EXPECT_EQ(s.block, 1);
}

TEST(BranchNames, FollowTheDirectionWhateverTheOrder) {
  EXPECT_THAT(branch_names({0}), ElementsAre("up"));
  EXPECT_THAT(branch_names({0, 50, 0}), ElementsAre("up", "up", "return"));
  EXPECT_THAT(branch_names({0, -50, 50, 0}), ElementsAre("down", "down", "up", "return"));
  EXPECT_THAT(branch_names({0, 50, -50, 50, 0}), ElementsAre("up", "up", "down", "up2", "return"));
  EXPECT_THAT(branch_names({0, 0, 50, 50, 0}), ElementsAre("up", "up", "up", "up", "return"));
}

ProcedureConfig called_average() {
  ProcedureConfig p = procedure("called", {step(config::Average{"$duration_s", "a"})});
  p.parameters = {{"duration_s", 60.0}};
  return p;
}

TEST(Expand, CallsInlineWithTheirParametersAndInheritTheTest) {
  const ProcedureLoader loader = [](const std::string& name,
                                    const ProcedureConfig&) -> Result<ProcedureConfig> {
    if (name == "called") return called_average();
    return procedure("middle", {step(config::Call{"called", {}, {}, 0})});
  };
  ProcedureConfig p = procedure("p", {step(config::Call{"called", {{"duration_s", "$d_s"}}, {}, 1}),
                                      step(config::Call{"middle", {}, {}, 2})});
  p.parameters = {{"d_s", 30.0}};
  const auto steps = expand(p, {}, loader);
  ASSERT_TRUE(steps) << steps.error().message;
  ASSERT_EQ(steps->size(), 2U);
  EXPECT_EQ(std::get<Average>((*steps)[0].action).duration, Seconds{30.0});
  EXPECT_EQ((*steps)[0].test, 1);
  EXPECT_EQ((*steps)[0].where, "called.json: /steps/0");
  EXPECT_EQ((*steps)[1].test, 2);
  EXPECT_EQ((*steps)[1].path, "2.1.1");
}

TEST(Expand, RefusesRecursionAndNamesTheChain) {
  const ProcedureLoader loader = [](const std::string& name,
                                    const ProcedureConfig&) -> Result<ProcedureConfig> {
    return procedure(name, {step(config::Call{name == "a" ? "b" : "a", {}, {}, 0})});
  };
  EXPECT_THAT(error_of(procedure("a", {step(config::Call{"b", {}, {}, 0})}), {}, loader),
              HasSubstr("a -> b -> a"));
}

TEST(Expand, NamesFilePointerAndFaultOfEveryMistake) {
  ProcedureConfig p = procedure("p", {});
  p.parameters = {{"one", 1.0}, {"list", std::vector<double>{1.0}}};
  const auto message = [&](decltype(config::Step::action) action) {
    p.steps = {config::Step{std::move(action), "/steps/0"}};
    return error_of(p);
  };
  const auto at_step = [](const std::string& what) {
    return AllOf(HasSubstr("p.json: /steps/0: "), HasSubstr(what));
  };
  EXPECT_THAT(message(config::Average{"$absent", ""}), at_step("no parameter \"absent\""));
  EXPECT_THAT(message(config::Average{"$list", ""}), at_step("expected one number"));
  EXPECT_THAT(message(config::Average{0.0, ""}), at_step("more than 0"));
  EXPECT_THAT(message(config::Average{std::nan(""), ""}), at_step("not finite"));
  EXPECT_THAT(message(config::Wait{-1.0, 0.0, "", 60.0}), at_step("0 or more"));
  EXPECT_THAT(message(config::SettleTemperature{0.1, 300.0, 1.0, 300.0, "", 60.0}),
              at_step("expected more than dwell_s"));
  EXPECT_THAT(message(config::Sweep{Axis::kX, "$one", 1.0, 1.0, ""}), at_step("expected a list"));
  EXPECT_THAT(message(config::Sweep{Axis::kX, std::vector<double>{}, 1.0, 1.0, ""}),
              at_step("levels_ut is empty"));
  EXPECT_THAT(message(config::Sweep{Axis::kX, std::vector<double>{0.0}, 1.0, 1.0, "a/b"}),
              at_step("no '/'"));
  EXPECT_THAT(message(config::Call{"absent", {}, {}, 0}), at_step("no such file"));
}

TEST(Expand, RefusesUnknownAndWrongOverrides) {
  ProcedureConfig p = procedure("p", {});
  p.parameters = {{"one", 1.0}};
  EXPECT_THAT(error_of(p, {{"two", 1.0}}), HasSubstr("no parameter \"two\" (known: one)"));
  EXPECT_THAT(error_of(p, {{"one", std::vector<double>{1.0}}}), HasSubstr("is a list"));
}

TEST(Expand, RefusesALoopGoneWrong) {
  const std::vector<double> many(1000, 1.0);
  const auto inner = step(config::ForEach{"b", many, {step(config::Prompt{"x"})}});
  EXPECT_THAT(error_of(procedure("p", {step(config::ForEach{"a", many, {inner}})})),
              HasSubstr("more than 100000 steps"));
}

TEST(Expand, LoopsThatLeaveNothingInThePlanEndToo) {
  const std::vector<double> many(1000, 0.0);
  const auto loop = [&](const char* variable, std::vector<config::Step> steps) {
    return step(config::ForEach{variable, many, std::move(steps)});
  };
  const auto nothing = step(config::Wait{0.0, 0.0, "", 60.0});
  EXPECT_THAT(error_of(procedure("p", {loop("a", {loop("b", {loop("c", {nothing})})})})),
              HasSubstr("expands to more than 100000 steps"));
}

std::vector<std::string> paths_of(const std::vector<PlannedStep>& steps) {
  std::vector<std::string> paths;
  for (const auto& s : steps) paths.push_back(s.path);
  return paths;
}

TEST(Expand, ARangeIsAListOfItsValuesWithParametersBound) {
  ProcedureConfig p = procedure(
      "p", {step(config::ForEach{"t_c",
                                 config::NumberRange{"$low_c", 31.0, 5.0},
                                 {step(config::SetTemperature{"$t_c", HeatingMode::kBoost})}})});
  p.parameters = {{"low_c", 21.0}};
  const auto steps = expand(p, {}, no_other);
  ASSERT_TRUE(steps) << steps.error().message;
  ASSERT_EQ(steps->size(), 3U);
  EXPECT_EQ(std::get<SetTemperature>((*steps)[2].action).target, Celsius{31.0});
  p.parameters = {{"low_c", 1e9}};
  EXPECT_THAT(error_of(p), AllOf(HasSubstr("/steps/0"), HasSubstr("values at most")));
}

TEST(Expand, ARampSettlesWhereItIsToAndCyclesComeAsOftenAsTheyAreTold) {
  const config::Ramp up{55.0, 120.0, HeatingMode::kBoost, true, "cycle/up", 30.0};
  ProcedureConfig p = procedure(
      "p", {step(config::Repeat{"$cycles", {step(up), step(config::Average{60.0, "a"})}})});
  p.parameters = {{"cycles", 2.0}};
  const auto steps = expand(p, {}, no_other);
  ASSERT_TRUE(steps) << steps.error().message;
  EXPECT_THAT(paths_of(*steps),
              ElementsAre("1.1.1.1", "1.1.1.2", "1.1.2", "1.2.1.1", "1.2.1.2", "1.2.2"));
  EXPECT_EQ(std::get<Ramp>((*steps)[0].action).rate, CelsiusPerHour{120.0});
  const auto& settle = std::get<SettleTemperature>((*steps)[1].action);
  EXPECT_EQ(settle.segment, "cycle/up");
  EXPECT_EQ(settle.window, Seconds{30.0});
  EXPECT_EQ((*steps)[3].phase_says, "turn 2 of 2");
  EXPECT_NE((*steps)[3].phase, (*steps)[2].phase);
  EXPECT_EQ((*steps)[3].phase, (*steps)[5].phase);
  p.parameters = {{"cycles", 1.5}};
  EXPECT_THAT(error_of(p), HasSubstr("times is 1.5, expected a whole number"));
  p.parameters = {{"cycles", 0.0}};
  EXPECT_TRUE(expand(p, {}, no_other)->empty());
}

TEST(Expand, ACallGivesListsAndPassesParametersOn) {
  ProcedureConfig sweep = procedure(
      "sweep", {step(config::Sweep{Axis::kX, "$levels_ut", "$average_s", 1.0, "coil_x"})});
  sweep.parameters = {{"levels_ut", std::vector<double>{0.0, 50.0, 0.0}}, {"average_s", 60.0}};
  const ProcedureLoader loader = [&](const std::string&, const ProcedureConfig&) {
    return Result<ProcedureConfig>(sweep);
  };
  const auto levels = [&](const ProcedureConfig& p, const Parameters& overrides = {}) {
    const auto steps = expand(p, overrides, loader);
    EXPECT_TRUE(steps) << steps.error().message;
    return steps ? steps->size() : 0U;
  };
  const auto call = [](config::Call made) { return procedure("p", {step(std::move(made))}); };
  EXPECT_EQ(levels(call({"sweep", {{"levels_ut", std::vector<double>{0.0, 9.0}}}})), 2U);
  EXPECT_EQ(levels(call({"sweep", {{"levels_ut", config::NumberRange{0.0, 30.0, 10.0}}}})), 4U);
  const ProcedureConfig passing = call({"sweep", {}, {"levels_ut"}});
  EXPECT_EQ(levels(passing), 3U) << "the default that it has there";
  EXPECT_EQ(levels(passing, {{"levels_ut", std::vector<double>{0.0, 1.0, 2.0, 3.0}}}), 4U);
  EXPECT_THAT(error_of(passing, {{"average_s", 5.0}}, loader),
              HasSubstr("no parameter \"average_s\" (known: levels_ut)"));
  EXPECT_THAT(error_of(call({"sweep", {}, {"absent"}}), {}, loader),
              AllOf(HasSubstr("/steps/0"), HasSubstr("no parameter \"absent\" to pass")));
  EXPECT_THAT(error_of(call({"sweep", {{"average_s", 1.0}}, {"average_s"}}), {}, loader),
              HasSubstr("stands in parameters and in pass"));
}

TEST(Expand, SaysAllThatIsWrongAndEachThingOnce) {
  ProcedureConfig p =
      procedure("p", {step(config::Average{"$absent", "a"}),
                      step(config::Repeat{3.0, {step(config::Average{-1.0, "a"})}}),
                      step(config::Ramp{31.0, 0.0}), step(config::Average{60.0, "good"})});
  std::vector<Error> problems;
  const auto steps = expand(p, {}, no_other, problems);
  ASSERT_EQ(problems.size(), 3U);
  EXPECT_THAT(problems[0].message, HasSubstr("no parameter \"absent\""));
  EXPECT_THAT(problems[1].message, HasSubstr("duration_s is -1"));
  EXPECT_THAT(problems[2].message, HasSubstr("rate_c_per_h is 0"));
  EXPECT_THAT(paths_of(steps), ElementsAre("4"));
}

}  // namespace
}  // namespace fogbench::procedures
