#include "config/scenario.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/config/changed_file.hpp"

namespace fogbench::config {
namespace {

using testing::HasSubstr;

std::string scenario_mistake(const std::string& text) {
  ChangedFile file;
  return message_of(load_scenario(file.write(text)));
}

TEST(NoiseGrade, HasTheTypicalCoefficients) {
  EXPECT_EQ(noise_grade("tactical")->angle_random_walk_deg_per_sqrt_h, 0.005);
  EXPECT_EQ(noise_grade("navigation")->bias_instability_deg_per_h, 0.003);
  EXPECT_EQ(noise_grade("none")->rate_random_walk_deg_per_h_per_sqrt_h, 0.0);
  EXPECT_EQ(message_of(noise_grade("strategic")),
            "noise grade \"strategic\" is not known; expected one of \"none\", \"navigation\", "
            "\"tactical\"");
}

TEST(LoadScenario, ReadsEveryPart) {
  ChangedFile file;
  const auto scenario = load_scenario(file.write(R"({
    "noise": {"angle_random_walk_deg_per_sqrt_h": 0.002, "quantisation_deg": 1e-5},
    "gyro": {"terms": {"bias": 0.7, "magnetic_linear_z": -0.25}},
    "hidden": [{"effect": "warm_up", "amplitude": 0.5, "tau": 900}],
    "magnetic_scale": [{"at_s": 10, "factor": 0.64}, {"at_s": 20, "factor": 1}],
    "faults": [{"device": "magnetometer", "at_s": 5400, "kind": "timeout", "for_s": 20},
               {"device": "coil_vertical", "operation": "set", "kind": "silent_execution",
                "at_operation": 3, "for_operations": 2}],
    "reference_temperature_c": 25})"));
  ASSERT_TRUE(scenario) << scenario.error().message;
  EXPECT_EQ(scenario->noise.angle_random_walk_deg_per_sqrt_h, 0.002);
  EXPECT_EQ(scenario->noise.quantisation_deg, 1e-5);
  EXPECT_EQ(scenario->terms.at("magnetic_linear_z"), -0.25);
  EXPECT_EQ(scenario->hidden.at(0).parameters.at("tau"), 900.0);
  EXPECT_EQ(scenario->magnetic_scale.at(0).factor, 0.64);
  EXPECT_EQ(scenario->faults.at(0).kind, FaultKind::kTimeout);
  EXPECT_EQ(scenario->faults.at(0).at, Seconds{5400});
  EXPECT_EQ(scenario->faults.at(0).duration, Seconds{20});
  EXPECT_FALSE(scenario->faults.at(0).at_operation);
  EXPECT_EQ(scenario->faults.at(1).at_operation, 3U);
  EXPECT_EQ(scenario->faults.at(1).operations, 2U);
  EXPECT_EQ(scenario->faults.at(1).operation, "set");
  EXPECT_EQ(scenario->reference_temperature, Celsius{25});
}

TEST(LoadScenario, MistakesAreNamed) {
  EXPECT_THAT(scenario_mistake(R"({"noise": "best"})"),
              HasSubstr("/noise: noise grade \"best\" is not known"));
  EXPECT_THAT(scenario_mistake(R"({"noise": 1})"),
              HasSubstr("/noise: found 1, expected a grade's name or an object"));
  EXPECT_THAT(scenario_mistake(R"({"noise": {"N": 1}})"), HasSubstr("/noise/N: unknown key"));
  EXPECT_THAT(scenario_mistake(R"({"gyro": {"terms": {"Bias": 1}}})"),
              HasSubstr("/gyro/terms/Bias: this key names something"));
  EXPECT_THAT(scenario_mistake(R"({"gyro": {"terms": {"bias": "1"}}})"),
              HasSubstr("/gyro/terms/bias: found \"1\", expected a number"));
  EXPECT_THAT(scenario_mistake(R"({"gyro": 1})"), HasSubstr("/gyro: found 1, expected an object"));
  EXPECT_THAT(scenario_mistake(R"({"gyro": {"term": {}}})"), HasSubstr("did you mean \"terms\"?"));
  EXPECT_THAT(scenario_mistake(R"({"hidden": [{"effect": "warm up", "amplitude": 1}]})"),
              HasSubstr("/hidden/0/effect: found \"warm up\""));
  EXPECT_THAT(scenario_mistake(R"({"hidden": [{"effect": "warm_up"}]})"),
              HasSubstr("/hidden/0: has no key \"amplitude\""));
  EXPECT_THAT(
      scenario_mistake(R"({"hidden": [{"effect": "warm_up", "amplitude": 1, "tau": "9"}]})"),
      HasSubstr("/hidden/0/tau: found \"9\", expected a number"));
  EXPECT_THAT(
      scenario_mistake(
          R"({"faults": [{"device": "a coil", "at_s": 0, "kind": "timeout", "for_s": 1}]})"),
      HasSubstr("/faults/0/device: found \"a coil\", expected a name of small letters"));
  EXPECT_THAT(scenario_mistake(
                  R"({"faults": [{"device": "gyro", "at_s": 0, "kind": "dead", "for_s": 1}]})"),
              HasSubstr("/faults/0/kind: found \"dead\", expected one of \"timeout\""));
  const auto of_fault = [](const std::string& keys) {
    return scenario_mistake(R"({"faults": [{"device": "gyro", "kind": "nan", )" + keys + "}]}");
  };
  EXPECT_THAT(of_fault(R"("operation": "read", "at_operation": 1)"),
              HasSubstr("/faults/0/operation: found \"read\", expected one of frame"));
  EXPECT_THAT(of_fault(R"("at_operation": 0)"), HasSubstr("/faults/0/at_operation: found 0"));
  for (const char* keys : {R"("at_s": 0, "for_s": 1, "at_operation": 1)", R"("for_operations": 1)"})
    EXPECT_THAT(of_fault(keys),
                HasSubstr("/faults/0: expected either at_s and for_s, or at_operation"));
  EXPECT_THAT(of_fault(R"("at_s": 0)"), HasSubstr("/faults/0: has at_s, but not for_s"));
  EXPECT_THAT(of_fault(R"("at_operation": 1, "for_s": 1)"),
              HasSubstr("/faults/0: has for_s, which goes with at_s"));
  EXPECT_THAT(of_fault(R"("at_s": 0, "for_s": 1, "for_operations": 2)"),
              HasSubstr("/faults/0: has for_operations, which goes with at_operation"));
  EXPECT_THAT(scenario_mistake(
                  R"({"magnetic_scale": [{"at_s": 9, "factor": 1}, {"at_s": 9, "factor": 2}]})"),
              HasSubstr("/magnetic_scale/1/at_s: found 9, expected a time after 9 s"));
}

}  // namespace
}  // namespace fogbench::config
