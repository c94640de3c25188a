#include "cli/draw_challenge.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "config/model_file.hpp"
#include "model/effects/catalogue.hpp"
#include "simulator/effects/effect.hpp"

namespace fogbench::cli {
namespace {

constexpr std::uint64_t kSeeds = 2000;

TEST(DrawChallenge, OneSeedIsOneDraw) {
  const ChallengeDraw a = draw_challenge(7), b = draw_challenge(7), other = draw_challenge(8);
  EXPECT_EQ(a.scenario.terms, b.scenario.terms);
  EXPECT_EQ(a.bench_seed, b.bench_seed);
  EXPECT_NE(a.scenario.terms, other.scenario.terms);
  EXPECT_NE(a.bench_seed, other.bench_seed);
}

TEST(DrawChallenge, HidesNothingOneOrTwoAsOftenAsItSays) {
  // 5, 27 and 8 of 40; five standard deviations of a count are 75, 105 and 90 of 2000.
  std::size_t counts[kMostHidden + 1] = {};
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const std::size_t hidden = draw_challenge(seed).scenario.hidden.size();
    ASSERT_LE(hidden, kMostHidden);
    ++counts[hidden];
  }
  EXPECT_NEAR(static_cast<double>(counts[0]), 250.0, 75.0);
  EXPECT_NEAR(static_cast<double>(counts[1]), 1350.0, 105.0);
  EXPECT_NEAR(static_cast<double>(counts[2]), 400.0, 90.0);
}

TEST(DrawChallenge, HidesEveryEffectThatItMayAndNoOther) {
  std::set<std::string> seen;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    for (const auto& effect : draw_challenge(seed).scenario.hidden) seen.insert(effect.effect);
  }
  const std::vector<std::string> may = hideable_effects();
  EXPECT_EQ(seen, std::set<std::string>(may.begin(), may.end()));
}

TEST(DrawChallenge, TheSimulatorHidesTheCataloguesEffectsAndNoOthers) {
  std::set<std::string> known, hidden;
  for (const model::Effect* effect : model::catalogue()) known.insert(effect->info().id);
  for (const simulator::EffectEntry& entry : simulator::all_effects()) {
    if (!entry.of_a_channel) hidden.insert(entry.id);
  }
  EXPECT_EQ(known, hidden);
}

TEST(DrawChallenge, WhatTheRoomsSensorsMeasureMayHideWithoutMovingOtherDraws) {
  const ChallengeRoom room{.bench = "simulated-auxiliary",
                           .channels = {"pressure_hpa", "supply_v"}};
  const std::vector<std::string> usual = hideable_effects();
  std::vector<std::string> more = usual;
  more.insert(more.end(), {"sensitivity(pressure_hpa)", "sensitivity(supply_v)"});
  EXPECT_EQ(hideable_effects(room), more);
  std::set<std::string> seen;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    for (const auto& effect : draw_challenge(seed, room).scenario.hidden) {
      seen.insert(effect.effect);
    }
  }
  EXPECT_EQ(seen, std::set<std::string>(more.begin(), more.end()));
}

TEST(DrawChallenge, TheProcedureDoesNotTellHowManyEffectsHide) {
  std::map<std::string, std::set<std::size_t>> counts;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const ChallengeDraw draw = draw_challenge(seed);
    counts[draw.procedure].insert(draw.scenario.hidden.size());
  }
  ASSERT_EQ(counts.size(), 3U);
  for (const auto& [procedure, seen] : counts) EXPECT_EQ(seen.size(), 3U) << procedure;
}

TEST(DrawChallenge, EveryEffectIsOfTheCatalogueWithItsParametersInRange) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    for (const auto& hidden : draw_challenge(seed).scenario.hidden) {
      const model::Effect* effect = model::find_effect(hidden.effect);
      ASSERT_NE(effect, nullptr) << hidden.effect;
      EXPECT_EQ(std::abs(hidden.amplitude), 1.0);
      for (const model::InnerParameter& inner : effect->info().parameters) {
        const auto drawn = hidden.parameters.find(std::string(inner.name));
        ASSERT_NE(drawn, hidden.parameters.end()) << hidden.effect << ' ' << inner.name;
        EXPECT_GE(drawn->second, inner.minimum) << hidden.effect;
        EXPECT_LE(drawn->second, inner.maximum) << hidden.effect;
      }
    }
  }
}

TEST(DrawChallenge, TheModelToStartFromHasNoneOfWhatHides) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const ChallengeDraw draw = draw_challenge(seed);
    ASSERT_EQ(draw.model.terms.size(), draw.scenario.terms.size());
    for (const config::ModelTerm& term : draw.model.terms) {
      EXPECT_TRUE(draw.scenario.terms.contains(term.effect));
      EXPECT_FALSE(term.coefficient);
      for (const auto& hidden : draw.scenario.hidden) EXPECT_NE(hidden.effect, term.effect);
    }
  }
}

}  // namespace
}  // namespace fogbench::cli
