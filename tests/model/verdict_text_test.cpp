// The three lines that a diagnosis begins with: verdict, evidence, what to do.

#include "model/diagnose/verdict_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace fogbench::model {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

MissingEffect effect_of(const std::string& name, std::vector<Estimate> estimates) {
  MissingEffect out;
  out.found.effect = name;
  out.found.p_value = 1e-6;
  out.found.heldout = {.better = 7, .folds = 8};
  out.estimates = std::move(estimates);
  out.rms_after = 0.01;
  out.heldout_rms_after = 0.011;
  return out;
}

Estimate estimate_of(const std::string& name, double value, double error, const std::string& unit) {
  Estimate out;
  out.name = name;
  out.value = value;
  out.standard_error = error;
  out.coverage_factor = 2.0;
  out.unit = unit;
  return out;
}

Diagnosis nothing_missing() {
  Diagnosis d;
  d.p_adequate = 0.4;
  d.before.fit.fitted.observable = "rate_deg_per_h";
  d.before.fit.rms = d.heldout_rms = 0.01;
  d.noise_floor = 0.0095;
  d.floor.white = 0.005;
  d.ladder = {{"", 0.01, 0.0102}};
  d.heldout_rms = 0.0102;
  return d;
}

Diagnosis step_missing() {
  Diagnosis d = nothing_missing();
  d.verdict = Verdict::kMissingEffect;
  d.p_adequate = 1e-6;
  d.missing = {effect_of("bias_step", {estimate_of("bias_step", 0.545, 0.026, "deg/h"),
                                       estimate_of("bias_step.t0", 3580, 5, "s")})};
  d.ladder = {{"", 0.2, 0.21}, {"bias_step", 0.01, 0.011}};
  d.heldout_rms = 0.21;
  return d;
}

TEST(VerdictInWords, NothingMissing) {
  const VerdictWords words = verdict_in_words(nothing_missing(), "fogbench fit x");
  EXPECT_EQ(words.verdict, "Nothing is missing that these data can show.");
  EXPECT_EQ(words.evidence,
            "The model leaves 0.01 deg/h RMS, and 0.0102 on rows held out of the fit, where noise "
            "alone leaves 0.0095; chance that noise alone looks so: p = 0.4.");
  EXPECT_EQ(words.to_do, "Next: fogbench fit x");
  EXPECT_EQ(words.sentences().size(), 3U);
}

TEST(VerdictInWords, AMissingEffectHasItsSizeInTheVerdictAndNowhereElse) {
  const VerdictWords words = verdict_in_words(step_missing(), "fogbench add bias_step");
  EXPECT_EQ(words.verdict, "Missing: bias_step = 0.545 +- 0.052 deg/h, t0 = 3580 +- 10 s.");
  EXPECT_EQ(words.evidence,
            "With bias_step the RMS residual falls from 0.2 to 0.01 deg/h, and from 0.21 to 0.011 "
            "on rows held out of the fit, where noise alone leaves 0.0095; chance that noise alone "
            "looks so: p < 0.0001.");
  EXPECT_EQ(words.to_do, "Next: fogbench add bias_step");
  EXPECT_THAT(words.details, Contains(AllOf(HasSubstr("7 of 8 parts"), Not(HasSubstr("0.545")))));
}

TEST(VerdictInWords, ASetAsksForTheMeasurementThatTellsItsMembersApart) {
  Diagnosis d = step_missing();
  d.verdict = Verdict::kAmbiguous;
  d.ambiguous = {{"bias_step", "earth_rate_projection"}};
  d.next_measurements = {{{"warm_up"}, "record time_s"}, {d.ambiguous[0], "turn it: 8 sigma"}};
  d.next_measurements[0].purpose = NextMeasurement::Purpose::kShow;
  const VerdictWords words = verdict_in_words(d, "fogbench fit x");
  EXPECT_EQ(words.verdict,
            "Missing: one of bias_step, earth_rate_projection; these data cannot say which.");
  EXPECT_EQ(words.to_do, "Measure: turn it: 8 sigma.");
  EXPECT_EQ(proposed_measurement(d), &d.next_measurements[1]);
  EXPECT_THAT(words.details, Contains(HasSubstr("bias_step = 0.545")));
}

TEST(VerdictInWords, AWalkBeyondInstrumentsAsksForARecordAtRest) {
  Diagnosis d = nothing_missing();
  d.verdict = Verdict::kAmbiguous;
  d.p_adequate = 1e-6;
  d.ambiguous = {{"drift_linear", "warm_up", "random_walk"}};
  d.walk_beyond = 32.0;
  const VerdictWords words = verdict_in_words(d, "fogbench fit x");
  EXPECT_EQ(words.verdict,
            "Missing: one of drift_linear, warm_up, random_walk; these data cannot say which.");
  EXPECT_THAT(words.evidence, AllOf(HasSubstr("white noise alone leaves 0.005"),
                                    HasSubstr("32 times what nine of ten such gyros")));
  EXPECT_THAT(words.to_do, HasSubstr("--quiet"));
}

TEST(VerdictInWords, AFormulaThatDoesBetterThanTheCatalogueComesFirst) {
  Diagnosis d = step_missing();
  d.verdict = Verdict::kUnexplained;
  d.far_from_floor = true;
  d.unexplained.depends_on = {"field_z_ut"};
  EXPECT_EQ(verdict_in_words(d, "").verdict,
            "Missing: bias_step, and that is not all; what is left depends on field_z_ut.");
  d.unexplained.suggestion = "field_z_ut * temperature_c";
  d.unexplained.heldout_rms = 0.004;
  const VerdictWords words = verdict_in_words(d, "");
  EXPECT_EQ(words.verdict,
            "Something is missing that the catalogue does not hold: field_z_ut * temperature_c "
            "does better than bias_step.");
  EXPECT_THAT(words.evidence, HasSubstr("the formula leaves 0.004 deg/h RMS"));
  EXPECT_THAT(words.to_do,
              HasSubstr(R"({"effect": "new", "expression": "field_z_ut * temperature_c"})"));
}

TEST(VerdictInWords, TooFewRowsAskForSoManyMore) {
  Diagnosis d = nothing_missing();
  d.judged = false;
  d.before.fit.fitted.terms.resize(2);
  d.before.sentences = {"It cannot be said.", "RMS 0.01 over 6 rows.", "The noise: unknown."};
  d.table.set_column("rate_deg_per_h", std::vector<double>(6, 0.7));
  const VerdictWords words = verdict_in_words(d, "fogbench fit x");
  EXPECT_EQ(words.verdict,
            "Cannot tell whether anything is missing: 6 rows beside 2 terms are too few.");
  EXPECT_EQ(words.evidence, "RMS 0.01 over 6 rows.");
  EXPECT_THAT(words.to_do, HasSubstr("3 more rows at least"));
  EXPECT_THAT(words.details, testing::ElementsAre("It cannot be said.", "The noise: unknown."));
}

}  // namespace
}  // namespace fogbench::model
