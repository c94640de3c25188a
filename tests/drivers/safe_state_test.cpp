#include "drivers/safe_state.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <set>
#include <string>
#include <vector>

#include "tests/support/fake_bench.hpp"

namespace fogbench::drivers {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

class MakeSafe : public testing::Test {
 protected:
  MakeSafe() : bench_(test::fake_bench(plant_)) {
    plant_.mode = HeatingMode::kNormal;
    plant_.current_a = {1.0, -2.0};
    plant_.output_on = {true, true};
  }
  Safety::State state_of(const SafetyReport& report, const std::string& actuator) {
    for (const Safety& safety : report.actuators) {
      if (safety.actuator == actuator) return safety.state;
    }
    ADD_FAILURE() << actuator << " is not reported";
    return Safety::State::kUnreachable;
  }

  test::FakePlant plant_;
  Bench bench_;
};

TEST_F(MakeSafe, SwitchesEverythingOff) {
  const SafetyReport report = make_safe(bench_);
  EXPECT_TRUE(report.reached());
  EXPECT_TRUE(report.status());
  EXPECT_TRUE(plant_.safe());
  EXPECT_EQ(report.text(),
            "coil_horizontal off, read back; coil_vertical off, read back; thermostat off, read "
            "back");
}

TEST_F(MakeSafe, TellsAllBeforeItWaitsForAny) {
  std::vector<std::string> calls;
  plant_.fails = [&](int, const std::string& name) {
    calls.push_back(name);
    return false;
  };
  EXPECT_TRUE(make_safe(bench_).reached());
  EXPECT_THAT(calls, ElementsAre("coil_horizontal.switch_off", "coil_vertical.switch_off",
                                 "thermostat.switch_off", "coil_horizontal.confirm_off",
                                 "coil_vertical.confirm_off", "thermostat.confirm_off"));
}

TEST_F(MakeSafe, TriesEveryInstrumentAndNamesAllThatFail) {
  plant_.fails = [](int, const std::string& name) {
    return name == "thermostat.confirm_off" || name.starts_with("coil_horizontal.");
  };
  const Status safe = make_safe(bench_).status();
  ASSERT_FALSE(safe);
  EXPECT_EQ(safe.error().code, ErrorCode::kDevice);
  EXPECT_THAT(safe.error().message,
              AllOf(HasSubstr("the safe state is not confirmed for coil_horizontal commanded off, "
                              "not confirmed (coil_horizontal.confirm_off did not answer)"),
                    HasSubstr("; thermostat commanded off"), Not(HasSubstr("coil_vertical"))));
  EXPECT_EQ(plant_.current_a[1], 0.0);
}

TEST_F(MakeSafe, WhoIsGoneIsUnreachableAndDelaysNobody) {
  plant_.gone = [](const std::string& name) { return name.starts_with("coil_horizontal."); };
  for (const ErrorCode code : {ErrorCode::kUnplugged, ErrorCode::kHeld}) {
    plant_.gone_as = code;
    const SafetyReport report = make_safe(bench_);
    EXPECT_EQ(state_of(report, "coil_horizontal"), Safety::State::kUnreachable);
    EXPECT_EQ(state_of(report, "coil_vertical"), Safety::State::kReadBack);
    EXPECT_EQ(state_of(report, "thermostat"), Safety::State::kReadBack);
    EXPECT_FALSE(report.reached());
    EXPECT_THAT(report.text(), HasSubstr("coil_horizontal unreachable (coil_horizontal."));
  }
}

TEST_F(MakeSafe, ALostMessageIsSentAgain) {
  std::set<std::string> heard;
  plant_.fails = [&](int, const std::string& name) { return heard.insert(name).second; };
  EXPECT_TRUE(make_safe(bench_).reached());
  EXPECT_TRUE(plant_.safe());
}

TEST_F(MakeSafe, BelievesTheHeatersPowerAndNotTheCommand) {
  plant_.heaters_stuck = true;
  const Status safe = make_safe(bench_).status();
  ASSERT_FALSE(safe);
  EXPECT_THAT(safe.error().message, HasSubstr("the heaters still draw 5.0 W"));
}

TEST_F(MakeSafe, AsksForNeitherIdentityNorReading) {
  plant_.fails = [](int, const std::string& name) {
    return name.ends_with(".identity") || name.ends_with(".read");
  };
  EXPECT_TRUE(make_safe(bench_).reached());
}

TEST_F(MakeSafe, OfTheCoilsLeavesTheHeatersAlone) {
  EXPECT_TRUE(coils_off(bench_).reached());
  EXPECT_EQ(plant_.mode, HeatingMode::kNormal);
  EXPECT_EQ(plant_.current_a, (std::array{0.0, 0.0}));
}

}  // namespace
}  // namespace fogbench::drivers
