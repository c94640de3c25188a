#include "config/procedure.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/config/changed_file.hpp"

namespace fogbench::config {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string step_mistake(const std::string& step) {
  ChangedFile file;
  return message_of(load_procedure(file.write(R"({"name": "p", "steps": [)" + step + "]}")));
}

TEST(LoadProcedure, ReadsEveryStep) {
  ChangedFile file;
  const auto procedure = load_procedure(file.write(R"({
    "name": "all", "parameters": {"levels_ut": [0, 50, -50], "window_s": 60, "cooling_c": []},
    "steps": [
      {"step": "set_temperature", "target_c": 31, "mode": "boost"},
      {"step": "settle_temperature", "band_c": 0.2, "segment": "heat", "window_s": "$window_s"},
      {"step": "wait", "operating_time_s": 2400},
      {"step": "average", "duration_s": "$window_s", "segment": "t"},
      {"step": "baseline", "duration_s": 60},
      {"step": "compensate_field", "tolerance_ut": 0.5},
      {"step": "rotate", "azimuth_deg": 90},
      {"step": "prompt", "text": "Close the lid."},
      {"step": "call", "procedure": "other", "parameters": {"a": 1, "b": "$window_s"}, "test": 2},
      {"step": "for_each", "variable": "t", "in": [31, 35], "steps": [
        {"step": "indivisible", "steps": [
          {"step": "sweep", "axis": "z", "levels_ut": "$levels_ut", "segment": "coil_z"}]}]}]})"));
  ASSERT_TRUE(procedure) << procedure.error().message;
  EXPECT_EQ(procedure->file, file.path());
  EXPECT_THAT(std::get<std::vector<double>>(procedure->parameters.at("levels_ut")),
              ElementsAre(0, 50, -50));
  EXPECT_TRUE(std::get<std::vector<double>>(procedure->parameters.at("cooling_c")).empty());
  ASSERT_EQ(procedure->steps.size(), 10U);
  EXPECT_EQ(std::get<SetTemperature>(procedure->steps[0].action).mode, HeatingMode::kBoost);
  const auto& settle = std::get<SettleTemperature>(procedure->steps[1].action);
  EXPECT_EQ(std::get<double>(settle.band_c), 0.2);
  EXPECT_EQ(std::get<double>(settle.dwell_s), 300.0);
  EXPECT_EQ(std::get<std::string>(settle.window_s), "$window_s");
  EXPECT_EQ(std::get<Call>(procedure->steps[8].action).test, 2);
  const auto& loop = std::get<ForEach>(procedure->steps[9].action);
  EXPECT_THAT(std::get<std::vector<double>>(loop.in), ElementsAre(31, 35));
  const auto& block = std::get<Indivisible>(loop.steps[0].action);
  EXPECT_EQ(std::get<Sweep>(block.steps[0].action).axis, Axis::kZ);
  EXPECT_EQ(block.steps[0].pointer, "/steps/9/steps/0/steps/0");
}

TEST(LoadProcedure, ReadsRampsCyclesAndRanges) {
  ChangedFile file;
  const auto procedure = load_procedure(file.write(R"({
    "name": "cycles", "parameters": {"cycles": 3, "targets_c": {"from": 20, "to": 50, "step": 10}},
    "steps": [
      {"step": "repeat", "times": "$cycles", "steps": [
        {"step": "ramp", "to_c": 55, "rate_c_per_h": 120, "settle": true, "segment": "up"}]},
      {"step": "for_each", "variable": "t_c", "in": {"from": "$low_c", "to": 50}, "steps": [
        {"step": "call", "procedure": "other", "pass": ["levels_ut"],
         "parameters": {"a": [1, 2], "b": {"from": 1, "to": 3}}}]}]})"));
  ASSERT_TRUE(procedure) << procedure.error().message;
  EXPECT_THAT(std::get<std::vector<double>>(procedure->parameters.at("targets_c")),
              ElementsAre(20, 30, 40, 50));
  const auto& cycle = std::get<Repeat>(procedure->steps[0].action);
  const auto& ramp = std::get<Ramp>(cycle.steps[0].action);
  EXPECT_EQ(std::get<double>(ramp.rate_c_per_h), 120.0);
  EXPECT_EQ(ramp.mode, HeatingMode::kBoost);
  EXPECT_TRUE(ramp.settle);
  const auto& loop = std::get<ForEach>(procedure->steps[1].action);
  EXPECT_EQ(std::get<std::string>(std::get<NumberRange>(loop.in).from), "$low_c");
  const auto& call = std::get<Call>(loop.steps[0].action);
  EXPECT_THAT(std::get<std::vector<double>>(call.parameters.at("a")), ElementsAre(1, 2));
  EXPECT_TRUE(std::holds_alternative<NumberRange>(call.parameters.at("b")));
  EXPECT_THAT(passed_parameters(*procedure), ElementsAre("levels_ut"));
}

TEST(LoadProcedure, ARangeEndsAtTheLastValueThatDoesNotPassItsEnd) {
  EXPECT_THAT(*range_values(20, 50, 10), ElementsAre(20, 30, 40, 50));
  EXPECT_THAT(*range_values(50, 20, 10), ElementsAre(50, 40, 30, 20)) << "down";
  EXPECT_THAT(*range_values(20, 50, 20), ElementsAre(20, 40));
  EXPECT_EQ(range_values(0, 0.3, 0.1)->size(), 4U) << "though not in floating point";
  EXPECT_EQ(range_values(0, 0.3, 0.1)->back(), 0.3);
  EXPECT_THAT(*range_values(7, 7, 1), ElementsAre(7));
  EXPECT_THAT(message_of(range_values(0, 1, 0)), HasSubstr("expected a step above 0"));
  EXPECT_THAT(message_of(range_values(0, 1, -1)), HasSubstr("expected a step above 0"));
  EXPECT_THAT(message_of(range_values(0, 1, 1e-9)), HasSubstr("100000 values at most"));
}

TEST(LoadProcedure, EverythingThatIsWrongIsSaidAtOnce) {
  ChangedFile file;
  ProcedureConfig procedure;
  const auto problems = check_procedure_file(file.write(R"({"name": "p", "steps": [
    {"step": "ramp", "to_c": 31},
    {"step": "waite", "duration_s": 5},
    {"step": "for_each", "variable": "x", "in": {"from": 1}, "steps": [
      {"step": "average", "duration_s": -1}]}]})"),
                                             procedure);
  std::string said;
  for (const Error& problem : problems) said += problem.message + "\n";
  EXPECT_EQ(problems.size(), 4U) << said;
  EXPECT_THAT(said, HasSubstr("/steps/0: has no key \"rate_c_per_h\""));
  EXPECT_THAT(said, HasSubstr("/steps/1/step"));
  EXPECT_THAT(said, HasSubstr("/steps/2/in: has no key \"to\""));
  EXPECT_THAT(said, HasSubstr("/steps/2/steps/0/duration_s"));
}

TEST(LoadProcedure, MistakesAreNamed) {
  EXPECT_THAT(step_mistake(R"({"step": "ramp", "to_c": 31, "rate_c_per_h": 0})"),
              HasSubstr("/steps/0/rate_c_per_h: found 0, expected a number above 0"));
  EXPECT_THAT(step_mistake(R"({"step": "ramp", "to_c": 31, "rate_c_per_h": 9, "mode": "off"})"),
              HasSubstr("/steps/0/mode: found \"off\", expected \"boost\" or \"normal\""));
  EXPECT_THAT(step_mistake(R"({"step": "for_each", "variable": "t", "in": 5, "steps": [
                               {"step": "prompt", "text": "x"}]})"),
              HasSubstr("expected a list of numbers, {\"from\", \"to\", \"step\"}, or the"));
  EXPECT_THAT(step_mistake(R"({"step": "measure"})"),
              HasSubstr("/steps/0/step: found \"measure\", expected one of set_temperature, "
                        "ramp, settle_temperature, wait,"));
  EXPECT_THAT(step_mistake(R"({"duration_s": 1})"), HasSubstr("/steps/0/step: found nothing"));
  EXPECT_THAT(step_mistake("7"), HasSubstr("/steps/0: found 7, expected an object"));
  EXPECT_THAT(step_mistake(""),
              HasSubstr("/steps: found an empty list, expected a list that is not"));
  EXPECT_THAT(step_mistake(R"({"step": "average", "duration_s": "60"})"),
              HasSubstr("/steps/0/duration_s: found \"60\", expected a number or the \"$name\" of "
                        "a parameter"));
  EXPECT_THAT(step_mistake(R"({"step": "average", "duration_s": 0})"),
              HasSubstr("/steps/0/duration_s: found 0, expected a number above 0"));
  EXPECT_THAT(step_mistake(R"({"step": "average", "duration_s": 60, "duration": 60})"),
              HasSubstr("did you mean \"duration_s\"?"));
  EXPECT_THAT(step_mistake(R"({"step": "set_temperature", "mode": "boost"})"),
              HasSubstr("/steps/0/target_c: found nothing, expected a set point"));
  EXPECT_THAT(step_mistake(R"({"step": "set_temperature", "mode": "fast", "target_c": 31})"),
              HasSubstr("expected one of \"off\", \"boost\", \"normal\""));
  EXPECT_THAT(step_mistake(R"({"step": "wait"})"),
              HasSubstr("/steps/0: has neither \"duration_s\""));
  EXPECT_THAT(step_mistake(R"({"step": "sweep", "axis": "x", "levels_ut": 50, "segment": "s"})"),
              HasSubstr("/steps/0/levels_ut: found 50, expected a list of numbers, {"));
  EXPECT_THAT(step_mistake(R"({"step": "sweep", "axis": "x", "levels_ut": [], "segment": "s"})"),
              HasSubstr("/steps/0/levels_ut: found an empty list"));
  EXPECT_THAT(step_mistake(R"({"step": "for_each", "variable": "T", "in": [1], "steps": [1]})"),
              HasSubstr("/steps/0/steps/0: found 1, expected an object"));
  EXPECT_THAT(step_mistake(R"({"step": "for_each", "variable": "T", "in": [1], "steps":
                          [{"step": "compensate_field"}]})"),
              HasSubstr("/steps/0/variable: found \"T\", expected a name of small letters"));
}

TEST(LoadProcedure, ParametersAreNumbersOrLists) {
  ChangedFile file;
  const auto with = [&](const std::string& parameters) {
    return message_of(load_procedure(
        file.write(R"({"name": "p", "steps": [{"step": "compensate_field"}], "parameters": )" +
                   parameters + "}")));
  };
  EXPECT_THAT(with(R"({"a": "1"})"),
              HasSubstr("/parameters/a: found \"1\", expected a number, a list of numbers or {"));
  EXPECT_THAT(with(R"({"A b": 1})"), HasSubstr("/parameters/A b: this key names something"));
}

TEST(LoadProcedure, StepsNestedWithoutEndAreAnError) {
  std::string text = R"({"name": "p", "steps": [)";
  for (int i = 0; i < 50000; ++i) text += R"({"step": "indivisible", "steps": [)";
  ChangedFile file;
  EXPECT_THAT(message_of(load_procedure(file.write(text))), HasSubstr("nested deeper than"));
}

}  // namespace
}  // namespace fogbench::config
