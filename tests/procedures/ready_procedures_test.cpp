// The procedures that come with fogbench, on the benches that come with it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "procedures/plan.hpp"
#include "tests/support/source_tree.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fogbench::procedures {
namespace {

using ::testing::HasSubstr;

const std::filesystem::path kConfig = tests::source_tree() / "config";

config::BenchConfig bench(const std::string& name) {
  const auto loaded = config::load_bench(kConfig / "benches" / (name + ".json"));
  EXPECT_TRUE(loaded) << loaded.error().message;
  return loaded ? *loaded : config::BenchConfig{};
}

Result<Plan> ready_plan(const std::string& procedure,
                        const std::map<std::string, config::ParameterValue>& overrides = {},
                        const std::string& on = "simulated") {
  const auto loaded = config::load_procedure(kConfig / "procedures" / (procedure + ".json"));
  if (!loaded) return loaded.error();
  return make_plan(*loaded, bench(on), overrides);
}

/// How many points of each segment a plan will measure, transients aside.
std::map<std::string, int> points_of(const Plan& plan, int test = 1) {
  std::map<std::string, int> points;
  for (const PlannedStep& step : plan.steps) {
    if (step.test != test) continue;
    if (const auto* average = std::get_if<Average>(&step.action)) ++points[average->segment];
    if (const auto* level = std::get_if<SweepLevel>(&step.action)) ++points[level->segment];
  }
  return points;
}

TEST(ReadyProcedures, AllCanBePlannedOnEveryReadyBenchButCyclesThatTakeACooler) {
  int plans = 0;
  for (const auto& procedure : std::filesystem::directory_iterator(kConfig / "procedures")) {
    for (const auto& file : std::filesystem::directory_iterator(kConfig / "benches")) {
      const auto plan =
          ready_plan(procedure.path().stem().string(), {}, file.path().stem().string());
      ++plans;
      if (procedure.path().stem() == "temperature-cycles" &&
          file.path().stem() != "simulated-chamber") {
        EXPECT_FALSE(plan) << file.path() << " cools";
        continue;
      }
      EXPECT_TRUE(plan) << file.path() << ": " << plan.error().message;
    }
  }
  EXPECT_GE(plans, 4 * 3);
}

TEST(ReadyProcedures, ThermostatStepsMeasuresEachSetPointThreeTimes) {
  const auto plan = ready_plan("thermostat-steps");
  ASSERT_TRUE(plan) << plan.error().message;
  EXPECT_EQ(points_of(*plan),
            (std::map<std::string, int>{{"thermostat/baseline", 1}, {"thermostat/plateau", 18}}));
  EXPECT_TRUE(std::get<Average>(plan->steps[1].action).baseline);
}

TEST(ReadyProcedures, ThermostatStepsCoolsWhenAskedTo) {
  const auto plan =
      ready_plan("thermostat-steps", {{"cooling_c", std::vector<double>{45.0, 35.0}}});
  ASSERT_TRUE(plan) << plan.error().message;
  EXPECT_EQ(points_of(*plan)["thermostat/cooling_plateau"], 6);
}

TEST(ReadyProcedures, CoilSweepGoesThroughThePapersLevelsOnThreeAxes) {
  const auto plan = ready_plan("coil-sweep");
  ASSERT_TRUE(plan) << plan.error().message;
  std::map<std::string, int> expected{{"coil/baseline", 2}};
  for (const std::string axis : {"coil_x", "coil_y", "coil_z"}) {
    expected[axis + "/up"] = 7;
    expected[axis + "/down"] = 12;
    expected[axis + "/return"] = 6;
  }
  EXPECT_EQ(points_of(*plan), expected);
}

TEST(ReadyProcedures, AcceptanceIsBothTwice) {
  const auto plan = ready_plan("acceptance");
  ASSERT_TRUE(plan) << plan.error().message;
  const auto first = points_of(*plan, 1);
  EXPECT_EQ(first, points_of(*plan, 2));
  EXPECT_EQ(first.at("thermostat/plateau"), 18);
  EXPECT_EQ(first.at("coil_z/down"), 12);
}

TEST(MakePlan, FindsACalledProcedureBesideTheCallersFile) {
  const support::TemporaryFolder folder;
  folder.file("outer.json",
              R"({"name": "outer", "steps": [{"step": "call", "procedure": "coil-sweep"}]})");
  folder.file(
      "coil-sweep.json",
      R"({"name": "own", "steps": [{"step": "average", "duration_s": 60, "segment": "own"}]})");
  const auto outer = config::load_procedure(folder / "outer.json");
  ASSERT_TRUE(outer) << outer.error().message;
  const auto plan = make_plan(*outer, bench("simulated"));
  ASSERT_TRUE(plan) << plan.error().message;
  EXPECT_EQ(points_of(*plan), (std::map<std::string, int>{{"own", 1}}));
}

TEST(MakePlan, NamesTheCallOfAProcedureThatDoesNotExist) {
  const support::TemporaryFolder folder;
  folder.file("outer.json",
              R"({"name": "outer", "steps": [{"step": "call", "procedure": "no-such"}]})");
  const auto outer = config::load_procedure(folder / "outer.json");
  ASSERT_TRUE(outer) << outer.error().message;
  const auto plan = make_plan(*outer, bench("simulated"));
  ASSERT_FALSE(plan);
  EXPECT_EQ(plan.error().code, ErrorCode::kBadInput);
  EXPECT_THAT(plan.error().message, HasSubstr("outer.json: /steps/0: no-such"));
}

}  // namespace
}  // namespace fogbench::procedures
