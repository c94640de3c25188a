// An effect with a memory that begins anywhere is named alone: what its beginning adds is no second
// effect. Seeds are fixed.

#include <gtest/gtest.h>

#include "model/diagnose/diagnose.hpp"
#include "model/diagnose/verdict_text.hpp"
#include "tests/model/cut_out_chamber.hpp"

namespace fogbench::model {
namespace {

void expect_alone(const Table& table, const std::string& effect) {
  const auto d = diagnose(table, model_of_effects({"bias", "temperature_linear"}), {});
  ASSERT_TRUE(d) << d.error().message;
  ASSERT_EQ(d->missing.size(), 1U) << verdict_in_words(*d, "").verdict;
  EXPECT_EQ(d->missing[0].found.effect, effect) << verdict_in_words(*d, "").verdict;
  EXPECT_NE(d->verdict, Verdict::kUnexplained) << verdict_in_words(*d, "").verdict;
}

TEST(UnknownBeginnings, ALagThatBeginsUnsettledIsNamedAlone) {
  for (const std::size_t first : {16u, 60u, 118u}) {
    expect_alone(cut_out(lagged_world(), 7.0, first, 0.004, 20U + static_cast<unsigned>(first)),
                 "temperature_rate_lagged");
  }
}

TEST(UnknownBeginnings, APlayThatBeginsAnywhereInItsBandIsNamedAlone) {
  for (const std::size_t first : {50u, 58u, 66u}) {
    expect_alone(cut_out(play_world(3.0), 7.0, first, 0.01, 30U + static_cast<unsigned>(first)),
                 "temperature_hysteresis");
  }
}

}  // namespace
}  // namespace fogbench::model
