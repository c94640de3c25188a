// Tables that nobody should have, and somebody will: a clear answer or one line, never a crash, a
// NaN or a confident name.

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "model/diagnose/diagnose.hpp"
#include "model/diagnose/verdict_text.hpp"
#include "model/diagnose/working_table.hpp"
#include "tests/model/models.hpp"

namespace fogbench::model {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

using Columns = std::map<std::string, std::vector<double>>;

/// A sweep of the field along z, `rows` windows of 180 s: bias, slope, and noise of a fixed pattern
/// (no two neighbours alike, nothing that an effect looks like).
Columns patterned_sweep(std::size_t rows, double noise = 0.005) {
  Columns out;
  std::uint32_t state = 12345;
  for (std::size_t i = 0; i < rows; ++i) {
    const double phase = 8.0 * static_cast<double>(i) / static_cast<double>(rows);
    const double level = phase < 2 ? phase : phase < 6 ? 4 - phase : phase - 8;
    state = state * 1664525u + 1013904223u;
    const double scatter = static_cast<double>(state >> 8) / (1u << 24) - 0.5;
    out["time_s"].push_back(200.0 * static_cast<double>(i + 1));
    out["duration_s"].push_back(180.0);
    out["field_z_ut"].push_back(150.0 * level);
    out["temperature_c"].push_back(25.0);
    out["rate_std_error_deg_per_h"].push_back(noise / std::sqrt(3.0));
    out["rate_deg_per_h"].push_back(0.7 - 0.25 * 1.5 * level + 2.0 * noise * scatter);
  }
  return out;
}

Table as_table(const Columns& columns) {
  Table out;
  for (const auto& [name, values] : columns) out.set_column(name, values);
  return out;
}

const config::ModelFile& line() {
  static const config::ModelFile kLine = model_of_effects({"bias", "magnetic_linear_z"});
  return kLine;
}

Result<Diagnosis> diagnosed(const Columns& columns, const config::ModelFile& model = line()) {
  return diagnose(as_table(columns), model, {});
}

void expect_adequate(const Result<Diagnosis>& result) {
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(name_of(result->verdict), "adequate");
  EXPECT_TRUE(result->missing.empty());
  EXPECT_TRUE(std::isfinite(result->p_adequate));
  EXPECT_TRUE(std::isfinite(result->before.fit.rms));
  EXPECT_FALSE(verdict_in_words(*result, "").verdict.empty());
}

void expect_refused(const Result<Diagnosis>& result, const std::string& says) {
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kBadInput);
  EXPECT_NE(result.error().message.find(says), std::string::npos) << result.error().message;
}

std::string refusal(const Diagnosis& d, const std::string& effect) {
  for (const NotTestable& n : d.not_testable) {
    if (n.effect == effect) return n.because;
  }
  return "";
}

TEST(DiagnoseDegenerate, TooFewRowsAreSaidToTellNothing) {
  for (const std::size_t rows : {2u, 3u, 6u}) {
    const auto result = diagnosed(patterned_sweep(rows));
    expect_adequate(result);
    EXPECT_FALSE(result->judged);
    EXPECT_EQ(
        verdict_in_words(*result, "").verdict.rfind("Cannot tell whether anything is missing", 0),
        0U)
        << verdict_in_words(*result, "").verdict;
  }
  expect_refused(diagnosed(patterned_sweep(1)), "found 1 usable rows, expected at least 2");
}

TEST(DiagnoseDegenerate, TwelveRowsAreJudged) {
  const auto result = diagnosed(patterned_sweep(12));
  expect_adequate(result);
  EXPECT_TRUE(result->judged);
}

TEST(DiagnoseDegenerate, PerfectFitMissesNothing) {
  Columns exact = patterned_sweep(24, 0.0);
  expect_adequate(diagnosed(exact));
  exact.erase("rate_std_error_deg_per_h");
  expect_adequate(diagnosed(exact));
}

TEST(DiagnoseDegenerate, PerfectFitButForOneEffectNamesIt) {
  Columns exact = patterned_sweep(24, 0.0);
  for (std::size_t i = 0; i < 24; ++i) {
    exact["rate_deg_per_h"][i] += 1e-5 * std::pow(exact["field_z_ut"][i], 2);
  }
  const auto result = diagnosed(exact);
  ASSERT_TRUE(result);
  ASSERT_FALSE(result->missing.empty());
  EXPECT_EQ(result->missing[0].found.effect, "magnetic_quadratic_z");
  EXPECT_TRUE(std::isfinite(result->missing[0].found.p_value));
}

TEST(DiagnoseDegenerate, ObservableThatStandsStill) {
  Columns still = patterned_sweep(24);
  still["rate_deg_per_h"].assign(24, 0.7);
  expect_adequate(diagnosed(still));
}

TEST(DiagnoseDegenerate, ConstantColumnsAreNotTestableAndSaid) {
  const auto result = diagnosed(patterned_sweep(24));
  expect_adequate(result);
  EXPECT_NE(refusal(*result, "temperature_linear"), "");
  EXPECT_NE(refusal(*result, "magnetic_linear_x"), "");
}

TEST(DiagnoseDegenerate, OneSetPointOnly) {
  Columns one = patterned_sweep(24);
  for (std::size_t i = 0; i < 24; ++i) {
    one["rate_deg_per_h"][i] += 0.0025 * (one["field_z_ut"][i] - 100.0);
  }
  one["field_z_ut"].assign(24, 100.0);
  expect_adequate(diagnosed(one, model_of_effects({"bias"})));
}

TEST(DiagnoseDegenerate, ColumnsOfNothing) {
  Columns columns = patterned_sweep(24);
  columns["temperature_c"].assign(24, kNan);
  const auto result = diagnosed(columns);
  expect_adequate(result);
  EXPECT_NE(refusal(*result, "temperature_linear"), "");
  columns["field_z_ut"].assign(24, kNan);
  expect_refused(diagnosed(columns), "field_z_ut");
}

TEST(DiagnoseDegenerate, GapsAreLeftOut) {
  Columns columns = patterned_sweep(48);
  for (std::size_t i = 0; i < 48; i += 5) columns["rate_deg_per_h"][i] = kNan;
  const auto result = diagnosed(columns);
  expect_adequate(result);
  EXPECT_EQ(result->table.rows(), 38U);
}

TEST(DiagnoseDegenerate, RowsWrittenTwiceCountOnce) {
  Columns twice;
  for (const auto& [name, values] : patterned_sweep(24)) {
    for (const double v : values) twice[name].insert(twice[name].end(), {v, v});
  }
  const auto result = diagnosed(twice);
  expect_adequate(result);
  EXPECT_EQ(result->table.rows(), 24U);
}

TEST(DiagnoseDegenerate, TimeThatStandsStillIsOfNoUse) {
  Columns columns = patterned_sweep(24);
  columns["time_s"].assign(24, 5.0);
  const auto result = diagnosed(columns);
  expect_adequate(result);
  EXPECT_NE(refusal(*result, "drift_linear"), "");
}

TEST(DiagnoseDegenerate, WindowsThatOverlapAreCutToTheStepBetweenThem) {
  Columns columns = patterned_sweep(24);
  columns["duration_s"].assign(24, 1e30);
  const auto table = WorkingTable::make(as_table(columns), line(), nullptr);
  ASSERT_TRUE(table);
  EXPECT_EQ(table->windows().duration_s.minCoeff(), 200.0);
  EXPECT_EQ(table->windows().duration_s.maxCoeff(), 200.0);
}

TEST(DiagnoseDegenerate, NumbersThatNoInstrumentGivesAreNamed) {
  const auto with = [](const std::string& name, double value) {
    Columns columns = patterned_sweep(24);
    columns[name][7] = value;
    return diagnosed(columns);
  };
  expect_refused(with("rate_deg_per_h", 1e300), "column rate_deg_per_h, row 8: found 1e+300");
  expect_refused(with("temperature_c", -1e300), "column temperature_c, row 8");
  expect_refused(with("rate_std_error_deg_per_h", -1.0), "found -1, expected 0");
  expect_refused(with("duration_s", -5.0), "found -5, expected 0");
}

TEST(DiagnoseDegenerate, StandardErrorsOfZeroTellNothing) {
  Columns columns = patterned_sweep(24);
  columns["rate_std_error_deg_per_h"].assign(24, 0.0);
  expect_adequate(diagnosed(columns));
}

TEST(DiagnoseDegenerate, StaticRecordWithoutTheObservableIsRefused) {
  const Table bench = as_table(patterned_sweep(24));
  const Table other = as_table({{"humidity", {1.0, 2.0}}});
  expect_refused(diagnose(bench, line(), {.quiet = &other}), "rate_deg_per_h");
  const Table empty;
  expect_refused(diagnose(bench, line(), {.quiet = &empty}), "rate_deg_per_h");
}

TEST(DiagnoseDegenerate, UsersCandidateTakesPart) {
  Columns columns = patterned_sweep(48);
  for (std::size_t i = 0; i < 48; ++i) {
    columns["rate_deg_per_h"][i] += 0.1 * std::sin(columns["field_z_ut"][i] / 20.0);
  }
  config::ModelTerm wave;
  wave.effect = "my_wave";
  wave.expression = "sin(field_z_ut / 20)";
  wave.unit = "deg/h";
  const auto result = diagnose(as_table(columns), line(), {.candidates = {wave}});
  ASSERT_TRUE(result);
  ASSERT_FALSE(result->missing.empty());
  EXPECT_EQ(result->missing[0].found.effect, "my_wave");
  ASSERT_FALSE(result->missing[0].estimates.empty());
  EXPECT_NEAR(result->missing[0].estimates[0].value, 0.1, 0.01);
}

/// Three published coefficients of two tests, as a table of one field a row.
Columns two_tests(const std::vector<double>& rates) {
  Columns out;
  for (std::size_t i = 0; i < 6; ++i) {
    out["rate_deg_per_h"].push_back(rates[i]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      out[fmt::format("field_{}_ut", "xyz"[axis])].push_back(i % 3 == axis ? 100.0 : 0.0);
    }
  }
  return out;
}

Result<Diagnosis> of_two_tests(const std::vector<double>& rates) {
  Table table = as_table(two_tests(rates));
  table.set_run({{"1", "2"}, {0, 0, 0, 1, 1, 1}});
  return diagnose(
      table, model_of_effects({"magnetic_linear_x", "magnetic_linear_y", "magnetic_linear_z"}), {});
}

TEST(DiagnoseDegenerate, OneScaleThatChangedBetweenTheTests) {
  const auto result = of_two_tests({-0.037, -0.576, -0.253, -0.043, -0.375, -0.145});
  ASSERT_TRUE(result);
  EXPECT_EQ(name_of(result->verdict), "missing_effect");
  ASSERT_EQ(result->missing.size(), 1U);
  EXPECT_EQ(result->missing[0].found.effect, "magnetic_change_between_runs");
  EXPECT_LT(result->missing[0].rms_after, 0.4 * result->before.fit.rms);
  EXPECT_NE(verdict_in_words(*result, "").sentences().back().find("common scale"),
            std::string::npos)
      << verdict_in_words(*result, "").sentences().back();
}

TEST(DiagnoseDegenerate, TwoTestsThatDifferByNoiseAreNotExplained) {
  const auto result = of_two_tests({-0.015, -0.008, -0.055, 0.009, 0.006, -0.041});
  expect_adequate(result);
  EXPECT_FALSE(result->judged);
  const auto says = verdict_in_words(*result, "").sentences();
  EXPECT_TRUE(std::any_of(says.begin(), says.end(), [](const std::string& s) {
    return s.find("magnetic_linear_x") != std::string::npos &&
           s.find("not distinguishable from zero") != std::string::npos;
  }));
}

TEST(DiagnoseDegenerate, ModelWithHeldCoefficients) {
  config::ModelFile held = line();
  for (config::ModelTerm& term : held.terms) term.fixed = true;
  held.terms[0].coefficient = 0.7;
  held.terms[1].coefficient = -0.25;
  expect_adequate(diagnosed(patterned_sweep(24), held));
}

}  // namespace
}  // namespace fogbench::model
