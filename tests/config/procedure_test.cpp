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

TEST(LoadProcedure, MistakesAreNamed) {
  EXPECT_THAT(step_mistake(R"({"step": "measure"})"),
              HasSubstr("/steps/0/step: found \"measure\", expected one of set_temperature, "
                        "settle_temperature, wait,"));
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
              HasSubstr("/steps/0/levels_ut: found 50, expected a list of numbers or the"));
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
              HasSubstr("/parameters/a: found \"1\", expected a number or a list of numbers"));
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
