#include "procedures/resume_plan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/paths.hpp"
#include "tests/support/source_tree.hpp"

namespace fogbench::procedures {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class ResumePlanTest : public testing::Test {
 protected:
  ResumePlanTest() {
    const auto ready = tests::source_tree() / "config";
    const auto bench = config::load_bench(ready / "benches/simulated.json");
    EXPECT_TRUE(bench);
    bench_ = *bench;
    const auto procedure = config::load_procedure(ready / "procedures/acceptance.json");
    EXPECT_TRUE(procedure);
    auto plan = make_plan(*procedure, bench_);
    EXPECT_TRUE(plan);
    whole_ = std::move(*plan);
  }

  std::size_t index_of(const std::string& path) const {
    for (std::size_t i = 0; i < whole_.steps.size(); ++i) {
      if (whole_.steps[i].path == path) return i;
    }
    ADD_FAILURE() << path;
    return 0;
  }
  ResumePlan resumed(const std::string& path) const {
    auto plan = resume_plan(whole_, index_of(path), bench_);
    EXPECT_TRUE(plan) << plan.error().message;
    return std::move(*plan);
  }
  static std::vector<std::string> paths(const ResumePlan& resumed) {
    std::vector<std::string> paths;
    for (std::size_t i = 0; i <= resumed.redone; ++i) paths.push_back(resumed.plan.steps[i].path);
    return paths;
  }

  config::BenchConfig bench_;
  Plan whole_;
};

TEST_F(ResumePlanTest, ASweepBeginsAnewFromItsFirstLevelTheGyroWarmAndTheFieldNulled) {
  const ResumePlan sweep = resumed("1.6.9");
  EXPECT_THAT(paths(sweep), ElementsAre("again 1.1", "again 1.2", "again 1.3", "1.6.1"));
  EXPECT_EQ(sweep.plan.steps.size(), 3 + whole_.steps.size() - index_of("1.6.1"));
  // After the turn the field was nulled anew, and only that counts.
  EXPECT_THAT(paths(resumed("1.10.4")),
              ElementsAre("again 1.1", "again 1.7", "again 1.8", "1.10.1"));
  EXPECT_THAT(paths(resumed("1.8")), ElementsAre("again 1.1", "again 1.7", "1.8"));
}

TEST_F(ResumePlanTest, AHeatingBeginsAnewFromTheTemperatureBeforeIt) {
  // 2.3.2 heats from 31 to 35 degC: from settled 31 degC on, with its transients.
  const ResumePlan heating = resumed("2.3.2.4");
  EXPECT_THAT(paths(heating),
              ElementsAre("again 1.11", "again 2.3.1.1", "again 2.3.1.2", "again 2.3.1.3",
                          "again 2.3.1.4", "again 2.3.1.5", "2.3.2.1"));
  for (std::size_t i = 0; i < heating.redone; ++i) {
    EXPECT_EQ(heating.plan.steps[i].says.find("recording"), std::string::npos);
  }
  EXPECT_NE(heating.plan.steps[heating.redone + 1].says.find("recording"), std::string::npos);
  EXPECT_EQ(std::get<SetTemperature>(heating.plan.steps[1].action).target, Celsius{31.0});
}

TEST_F(ResumePlanTest, APointOnAPlateauIsRepeatedAloneOnceThePlateauIsReachedAgain) {
  const ResumePlan plateau = resumed("2.3.2.6.2.1");
  EXPECT_EQ(paths(plateau).back(), "2.3.2.6.2.1");
  EXPECT_EQ(std::get<SetTemperature>(plateau.plan.steps[1].action).target, Celsius{35.0});
  EXPECT_GT(plateau.plan.estimate, Seconds{1800.0}) << "heating and soak are in the estimate";
}

TEST_F(ResumePlanTest, BeforeTheFirstStepAndAfterTheLastNothingIsRedone) {
  const auto begin = resume_plan(whole_, 0, bench_);
  ASSERT_TRUE(begin);
  EXPECT_EQ(begin->redone, 0U);
  EXPECT_EQ(begin->plan.steps.size(), whole_.steps.size());
  const auto end = resume_plan(whole_, whole_.steps.size(), bench_);
  ASSERT_TRUE(end) << end.error().message;
  EXPECT_THAT(end->plan.steps, IsEmpty());
}

TEST_F(ResumePlanTest, ATargetThatWasSetWithinABlockIsNotForgotten) {
  Plan plan;
  const auto add = [&plan](auto action, int block) {
    PlannedStep step;
    step.action = action;
    step.path = std::to_string(plan.steps.size() + 1);
    step.block = block;
    plan.steps.push_back(step);
  };
  add(SetTemperature{Celsius{40.0}, HeatingMode::kNormal}, 1);
  add(Wait{Seconds{60.0}, Seconds{0.0}, "in_block", Seconds{10.0}}, 1);
  add(Average{Seconds{60.0}, "after"}, 0);
  const auto average = resume_plan(plan, 2, bench_);
  ASSERT_TRUE(average) << average.error().message;
  EXPECT_THAT(paths(*average), ElementsAre("again 1", "3"));
  EXPECT_EQ(first_step_left(plan, 1), 0U);
}

TEST(ResumePlan, ARampBeginsAnewFromWhereTheOneBeforeItEnded) {
  Plan plan;
  const auto add = [&plan](auto action) {
    PlannedStep step;
    step.action = action;
    step.path = std::to_string(plan.steps.size() + 1);
    plan.steps.push_back(step);
  };
  const auto cycle = [&] {
    add(Ramp{Celsius{55.0}, CelsiusPerHour{120.0}, HeatingMode::kBoost, "up", Seconds{30.0}});
    add(Wait{Seconds{600.0}, Seconds{0.0}, "high", Seconds{60.0}});
    add(Ramp{Celsius{25.0}, CelsiusPerHour{120.0}, HeatingMode::kBoost, "down", Seconds{30.0}});
    add(Wait{Seconds{600.0}, Seconds{0.0}, "low", Seconds{60.0}});
  };
  cycle();
  cycle();
  // In the second ramp down, and in the wait that follows it.
  for (const std::size_t at : {6U, 7U}) {
    const auto resumed = resume_plan(plan, at, {});
    ASSERT_TRUE(resumed) << resumed.error().message;
    EXPECT_EQ(resumed->first, 6U);
    std::vector<std::string> paths;
    for (const auto& step : resumed->plan.steps) paths.push_back(step.path);
    EXPECT_THAT(paths, ElementsAre("again 5.1", "again 5.2", "again 6", "7", "8"));
    EXPECT_EQ(std::get<SetTemperature>(resumed->plan.steps[0].action).target, Celsius{55.0});
    EXPECT_EQ(std::get<Wait>(resumed->plan.steps[2].action).segment, "");
    EXPECT_EQ(std::get<Ramp>(resumed->plan.steps[3].action).segment, "down");
  }
  EXPECT_EQ(first_step_left(plan, 0), 0U);
}

}  // namespace
}  // namespace fogbench::procedures
