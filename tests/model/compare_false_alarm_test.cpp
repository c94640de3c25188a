// How often `p_adequate` falls below 5 % where the model is right: white noise without times, and
// coloured noise of each grade on loops of a sweep. Measured with 200 seeds each, in per cent:
//   white 7.0, navigation 8.5, tactical 6.5, random walk 5.0; together 6.8 +- 0.9
// A little above the nominal 5; the bound below is what 200 seeds of such a rate may show.

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "model/compare.hpp"
#include "tests/model/models.hpp"
#include "tests/support/diagnosis_trial.hpp"

namespace fogbench::model {
namespace {

constexpr int kAlarmSeeds = 200;
constexpr double kMostPercent = 9.0;

/// The loops without their times and standard errors.
Table untimed(const Table& loops) {
  Table table;
  for (const char* name : {"rate_deg_per_h", "field_z_ut"}) {
    const auto values = loops.column(name);
    table.set_column(name, {values.begin(), values.end()});
  }
  table.set_segment(loops.segment());
  return table;
}

double alarms_percent(const NoiseCoefficients& noise, bool timed) {
  const auto model = model_of_effects({"bias", "magnetic_linear_z"});
  int alarms = 0;
  for (unsigned seed = 1; seed <= kAlarmSeeds; ++seed) {
    const Table loops = noisy_loops(noise, seed, 3, 0.0);
    const auto result = compare(timed ? loops : untimed(loops), model, {}, seed);
    if (!result) return 100.0;
    alarms += result->p_adequate < 0.05;
  }
  const double percent = 100.0 * alarms / kAlarmSeeds;
  std::cout << "false alarms " << percent << " %\n";
  return percent;
}

TEST(CompareFalseAlarms, AreRareUnderWhiteNoise) {
  EXPECT_LE(alarms_percent({0.005, 0.0, 0.0, 0.0}, false), kMostPercent);
}

TEST(CompareFalseAlarms, AreRareUnderNavigationNoise) {
  EXPECT_LE(alarms_percent(kNavigation, true), kMostPercent);
}

TEST(CompareFalseAlarms, AreRareUnderTacticalNoise) {
  EXPECT_LE(alarms_percent(kTactical, true), kMostPercent);
}

TEST(CompareFalseAlarms, AreRareUnderARandomWalk) {
  EXPECT_LE(alarms_percent({0.001, 0.0, 0.01, 0.0}, true), kMostPercent);
}

// Effects with a memory, or that act for a while, move the mean of no range.
TEST(Compare, NeverCallsNoiseWhatADiagnosisNames) {
  using tests::Design;
  const std::vector<tests::DiagnosisCase> cases{
      {.part = "look", .design = Design::kThermalCooling, .hidden = {"temperature_hysteresis"}},
      {.part = "look", .design = Design::kThermalCooling, .hidden = {"temperature_rate_lagged"}},
      {.part = "look", .design = Design::kMagnetic, .hidden = {"magnetic_settling_x"}},
      {.part = "look", .design = Design::kMagnetic, .hidden = {"magnetic_hysteresis_z"}},
      {.part = "look", .design = Design::kMixed, .hidden = {"warm_up"}}};
  tests::TrialMaker maker;
  int named = 0;
  for (tests::DiagnosisCase what : cases) {
    what.s = 10.0;
    for (std::uint64_t number = 0; number < 3; ++number) {
      const tests::Trial trial = maker.make(what, number);
      if (tests::answer_of(trial).verdict == Verdict::kNothingMissing) continue;
      ++named;
      const auto result = compare(trial.table, trial.model, {});
      ASSERT_TRUE(result) << result.error().message;
      EXPECT_LT(result->p_adequate, kAdequate) << what.name() << " #" << number;
    }
  }
  EXPECT_GT(named, 10);
}

}  // namespace
}  // namespace fogbench::model
