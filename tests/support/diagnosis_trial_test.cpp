#include "tests/support/diagnosis_trial.hpp"

#include <gtest/gtest.h>

namespace fogbench::tests {
namespace {

using model::Verdict;

Answer missing(std::vector<std::vector<std::string>> sets) {
  return {.verdict = Verdict::kMissingEffect, .sets = std::move(sets)};
}

TEST(Judge, NamesTheWaysToBeRightAndWrongAboutOneEffect) {
  const std::vector<std::string> truth{"warm_up"};
  EXPECT_EQ(judge(missing({{"warm_up"}}), truth), Outcome::kRight);
  EXPECT_EQ(judge(missing({{"drift_linear", "warm_up"}}), truth), Outcome::kRightInSet);
  EXPECT_EQ(judge(missing({{"a", "b", "c", "warm_up"}}), truth), Outcome::kLargeSet);
  EXPECT_EQ(judge(missing({{"drift_linear", "bias_step"}}), truth), Outcome::kSetWithoutTruth);
  EXPECT_EQ(judge(missing({{"drift_linear"}}), truth), Outcome::kWrongName);
  EXPECT_EQ(judge(missing({{"drift_linear"}, {"bias_step"}}), truth), Outcome::kWrongName);
  EXPECT_EQ(judge(missing({{"drift_linear"}, {"warm_up"}}), truth), Outcome::kExtra);
  EXPECT_EQ(judge({.verdict = Verdict::kUnexplained, .sets = {{"warm_up"}}}, truth),
            Outcome::kUnexplained);
  EXPECT_EQ(judge({}, truth), Outcome::kAdequate);
}

TEST(Judge, GivesEachOfAPairItsOwnSet) {
  const std::vector<std::string> truth{"warm_up", "bias_step"};
  EXPECT_EQ(judge(missing({{"bias_step"}, {"warm_up"}}), truth), Outcome::kRight);
  EXPECT_EQ(judge(missing({{"bias_step", "warm_up"}, {"bias_step"}}), truth), Outcome::kRightInSet);
  EXPECT_EQ(judge(missing({{"bias_step", "warm_up"}}), truth), Outcome::kPartOnly);
  EXPECT_EQ(judge(missing({{"bias_step", "warm_up"}, {"drift_linear"}}), truth), Outcome::kExtra);
}

TEST(Judge, ToleratesADoubtAboutARandomWalkWhereNothingIsHidden) {
  EXPECT_EQ(judge(missing({{"drift_linear", "random_walk"}}), {}), Outcome::kRightInSet);
  EXPECT_EQ(judge(missing({{"drift_linear", "random_walk"}, {"warm_up"}}), {}),
            Outcome::kSetWithoutTruth);
  EXPECT_EQ(judge(missing({{"drift_linear"}}), {}), Outcome::kWrongName);
}

TEST(Judge, CountsACaveatAsAFlagOnlyOutsideTheCatalogue) {
  Answer answer = missing({{"magnetic_quadratic_z"}});
  answer.or_shape = "|field_z_ut|";
  EXPECT_EQ(judge(answer, {"outside_sqrt_field_z"}), Outcome::kHedged);
  EXPECT_EQ(judge(answer, {"magnetic_quadratic_z"}), Outcome::kRight);
  answer.or_shape.clear();
  EXPECT_EQ(judge(answer, {"outside_sqrt_field_z"}), Outcome::kWrongName);
  EXPECT_EQ(judge(answer, {}), Outcome::kWrongName);
}

TEST(TrialMaker, TheSameCaseAndNumberGiveTheSameTrial) {
  const DiagnosisCase what{
      .part = "effects", .design = Design::kOneAxis, .hidden = {"magnetic_linear_z"}, .s = 9.0};
  TrialMaker maker, other;
  const Trial a = maker.make(what, 3), b = other.make(what, 3), c = maker.make(what, 4);
  EXPECT_EQ(a.seed, b.seed);
  EXPECT_NE(a.seed, c.seed);
  EXPECT_EQ(a.table.column("rate_deg_per_h")[7], b.table.column("rate_deg_per_h")[7]);
  // What is hidden is not in the model that the experimenter has.
  ASSERT_EQ(a.model.terms.size(), 1U);
  EXPECT_EQ(a.model.terms[0].effect, "bias");
}

}  // namespace
}  // namespace fogbench::tests
