#include "cli/score.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.hpp"

namespace fogbench::cli {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Answer answer(std::vector<Claim> claims) {
  return {.claims = std::move(claims)};
}

TEST(Score, TheHiddenEffectNamedAloneIsExactlyRight) {
  const Score scored = score({"warm_up"}, answer({{"warm_up"}}));
  EXPECT_THAT(scored.right, ElementsAre("warm_up"));
  EXPECT_TRUE(scored.exact());
}

TEST(Score, NothingIsRightWhereNothingHidesOnly) {
  EXPECT_TRUE(score({}, answer({})).exact());
  EXPECT_THAT(score({"warm_up"}, answer({})).missed, ElementsAre("warm_up"));
}

TEST(Score, OneOfTwoIsNotExact) {
  const Score scored = score({"warm_up", "bias_step"}, answer({{"bias_step"}}));
  EXPECT_THAT(scored.right, ElementsAre("bias_step"));
  EXPECT_THAT(scored.missed, ElementsAre("warm_up"));
  EXPECT_FALSE(scored.exact());
}

TEST(Score, AnEffectThatDoesNotHideIsInvented) {
  const Score scored = score({"warm_up"}, answer({{"warm_up"}, {"bias_step"}}));
  EXPECT_THAT(scored.invented, ElementsAre("bias_step"));
  EXPECT_FALSE(scored.exact());
}

TEST(Score, ASetOfAtMostThreeNamesAnswersForOneEffect) {
  const Score scored = score({"warm_up"}, answer({{"drift_linear", "warm_up", "random_walk"}}));
  EXPECT_THAT(scored.in_set, ElementsAre("warm_up"));
  EXPECT_TRUE(scored.exact());
  const Score both = score({"warm_up", "drift_linear"}, answer({{"drift_linear", "warm_up"}}));
  EXPECT_THAT(both.in_set, ElementsAre("warm_up"));
  EXPECT_THAT(both.missed, ElementsAre("drift_linear"));
}

TEST(Score, ASetOfMoreNamesIsNoAnswer) {
  const Score scored =
      score({"warm_up"}, answer({{"drift_linear", "warm_up", "bias_step", "random_walk"}}));
  EXPECT_THAT(scored.missed, ElementsAre("warm_up"));
  EXPECT_THAT(scored.invented, IsEmpty());
}

TEST(Score, ASurerClaimIsTakenBeforeASet) {
  const Score scored =
      score({"warm_up", "bias_step"}, answer({{"bias_step", "warm_up"}, {"warm_up"}}));
  EXPECT_THAT(scored.right, ElementsAre("warm_up"));
  EXPECT_THAT(scored.in_set, ElementsAre("bias_step"));
}

TEST(Score, WhatNoiseMayExplainIsNotInvented) {
  EXPECT_TRUE(score({}, answer({{"drift_linear", "random_walk"}})).exact());
  EXPECT_THAT(score({}, answer({{"drift_linear", "warm_up"}})).invented,
              ElementsAre("drift_linear or warm_up"));
}

TEST(Score, SomethingWithoutANameIsInvented) {
  Answer unexplained = answer({{"warm_up"}});
  unexplained.unnamed = true;
  EXPECT_THAT(score({"warm_up"}, unexplained).invented, ElementsAre("something without a name"));
}

TEST(AnswerFrom, TakesEffectsOrNothing) {
  EXPECT_THAT(answer_from({"warm_up", "bias_step"})->claims,
              ElementsAre(Claim{"warm_up"}, Claim{"bias_step"}));
  EXPECT_THAT(answer_from({"nothing"})->claims, IsEmpty());
}

TEST(AnswerFrom, RefusesWhatCannotBeAnAnswer) {
  const auto message = [](const std::vector<std::string>& effects) {
    const auto refused = answer_from(effects);
    return refused ? "accepted" : refused.error().message;
  };
  EXPECT_THAT(message({"warm_upp"}), HasSubstr("did you mean \"warm_up\"?"));
  EXPECT_THAT(message({"nothing", "warm_up"}), HasSubstr("nothing beside an effect"));
  EXPECT_THAT(message({"warm_up", "warm_up"}), HasSubstr("twice"));
}

class ReadDiagnosisTest : public testing::Test {
 protected:
  Result<Answer> read(const std::string& text) const {
    return read_diagnosis(folder_.file("diagnosis.json", text));
  }
  support::TemporaryFolder folder_;
};

TEST_F(ReadDiagnosisTest, AdequateIsNothing) {
  const auto read_back = read(R"({"verdict": "adequate", "p_adequate": 0.4, "missing": []})");
  ASSERT_TRUE(read_back) << read_back.error().message;
  EXPECT_THAT(read_back->claims, IsEmpty());
  EXPECT_FALSE(read_back->unnamed);
}

TEST_F(ReadDiagnosisTest, AnEffectOfAnAmbiguousSetStandsForTheSet) {
  const auto read_back = read(
      R"({"verdict": "ambiguous", "missing": [{"effect": "bias_step"}, {"effect": "warm_up"}],
          "ambiguous": [["earth_rate_projection", "bias_step"]]})");
  ASSERT_TRUE(read_back) << read_back.error().message;
  EXPECT_THAT(read_back->claims,
              ElementsAre(Claim{"warm_up"}, (Claim{"earth_rate_projection", "bias_step"})));
}

TEST_F(ReadDiagnosisTest, UnexplainedSaysThatMoreIsThere) {
  const auto read_back = read(R"({"verdict": "unexplained", "missing": [{"effect": "warm_up"}]})");
  ASSERT_TRUE(read_back) << read_back.error().message;
  EXPECT_TRUE(read_back->unnamed);
  EXPECT_THAT(read_back->claims, ElementsAre(Claim{"warm_up"}));
}

TEST_F(ReadDiagnosisTest, SaysWhatIsWrongAndWhere) {
  const auto message = [&](const std::string& text) {
    const auto refused = read(text);
    return refused ? "accepted" : refused.error().message;
  };
  EXPECT_THAT(message("[]"), HasSubstr("what fogbench diagnose --json printed"));
  EXPECT_THAT(message("{}"), HasSubstr("/verdict"));
  EXPECT_THAT(message(R"({"verdict": "fine"})"), HasSubstr("one of adequate, missing_effect"));
  EXPECT_THAT(message(R"({"verdict": "ambiguous", "missing": {}})"), HasSubstr("/missing"));
  EXPECT_THAT(message(R"({"verdict": "ambiguous", "missing": [7]})"), HasSubstr("/missing/0"));
  EXPECT_THAT(message(R"({"verdict": "ambiguous", "missing": [{}]})"),
              HasSubstr("/missing/0/effect"));
  EXPECT_THAT(message(R"({"verdict": "ambiguous", "ambiguous": [["warm_up", 1]]})"),
              HasSubstr("/ambiguous/0/1"));
  EXPECT_THAT(read_diagnosis(folder_ / "none.json").error().message, HasSubstr("none.json"));
}

}  // namespace
}  // namespace fogbench::cli
