// What must not change a diagnosis: how the table was written down, and how the work was done.

#include <gtest/gtest.h>
#include <sched.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <set>

#include "model/diagnose/diagnose.hpp"
#include "model/diagnose/library.hpp"
#include "model/diagnose/search.hpp"
#include "model/diagnose/verdict_text.hpp"
#include "model/diagnose/working_table.hpp"
#include "model/table/signals.hpp"
#include "tests/support/diagnosis_trial.hpp"

namespace fogbench::model {
namespace {

// Sums in another order differ in their last digits; the scores behind a p-value are floats.
constexpr double kRounding = 1e-3;

tests::Trial trial() {
  return tests::TrialMaker().make(
      {.part = "invariance", .hidden = {"magnetic_hysteresis_z"}, .s = 16.0}, 1);
}

Diagnosis diagnosed_trial(const Table& table, const DiagnoseOptions& options = {}) {
  const auto result = diagnose(table, trial().model, options);
  EXPECT_TRUE(result) << (result ? "" : result.error().message);
  return result ? *result : Diagnosis{};
}

const Diagnosis& reference() {
  static const Diagnosis kReference = diagnosed_trial(trial().table);
  return kReference;
}

void expect_same(const Diagnosis& a, const Diagnosis& b, double scale = 1.0) {
  EXPECT_EQ(name_of(a.verdict), name_of(b.verdict));
  EXPECT_EQ(a.ambiguous, b.ambiguous);
  ASSERT_EQ(a.missing.size(), b.missing.size());
  for (std::size_t i = 0; i < a.missing.size(); ++i) {
    const Found &f = a.missing[i].found, &g = b.missing[i].found;
    EXPECT_EQ(f.effect, g.effect);
    EXPECT_NEAR(f.p_value, g.p_value, kRounding * f.p_value + 1e-30);
    EXPECT_NEAR(f.inner, g.inner, kRounding * std::abs(f.inner));
    EXPECT_NEAR(a.missing[i].rms_after * scale, b.missing[i].rms_after,
                kRounding * b.missing[i].rms_after);
  }
  EXPECT_NEAR(a.heldout_rms * scale, b.heldout_rms, kRounding * b.heldout_rms);
  EXPECT_NEAR(a.noise_floor * scale, b.noise_floor, kRounding * b.noise_floor);
}

/// The table's rows in an order of chance.
Table shuffled(const Table& table) {
  std::vector<std::size_t> order(table.rows());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::shuffle(order.begin(), order.end(), std::mt19937_64(4));
  Table out;
  for (const std::string& name : table.column_names()) {
    std::vector<double> column;
    for (const std::size_t row : order) column.push_back(table.column(name)[row]);
    out.set_column(name, std::move(column));
  }
  const auto texts = [&](const TextColumn& from) {
    TextColumn to{from.values, {}};
    for (const std::size_t row : order) to.index.push_back(from.index[row]);
    return to;
  };
  out.set_run(texts(table.run()));
  out.set_segment(texts(table.segment()));
  return out;
}

/// Every number of the column, changed.
template <class Change>
void change(Table& table, const std::string& name, const Change& of) {
  const auto values = table.column(name);
  std::vector<double> column(values.begin(), values.end());
  std::transform(column.begin(), column.end(), column.begin(), of);
  table.set_column(name, std::move(column));
}

Table in_run(Table table, const std::string& run) {
  table.set_run({{run}, std::vector<std::uint32_t>(table.rows(), 0)});
  return table;
}

TEST(DiagnoseInvariance, TheEffectIsFoundAtAll) {
  ASSERT_EQ(reference().missing.size(), 1U);
  const Found& found = reference().missing[0].found;
  std::vector<std::string> names{found.effect};
  for (const Rival& rival : found.rivals) names.push_back(rival.effect);
  EXPECT_NE(std::find(names.begin(), names.end(), "magnetic_hysteresis_z"), names.end());
}

TEST(DiagnoseInvariance, RowsInAnyOrder) {
  expect_same(reference(), diagnosed_trial(shuffled(trial().table)));
}

TEST(DiagnoseInvariance, RunsInAnyOrder) {
  const Table table = trial().table;
  Table forth = in_run(table, "1"), back = in_run(table, "2");
  forth.append(in_run(table, "2"));
  back.append(in_run(table, "1"));
  expect_same(diagnosed_trial(forth), diagnosed_trial(shuffled(back)));
}

TEST(DiagnoseInvariance, ConstantThatTheBiasTakesUp) {
  Table table = trial().table;
  change(table, "rate_deg_per_h", [](double v) { return v + 15.041; });
  expect_same(reference(), diagnosed_trial(table));
}

TEST(DiagnoseInvariance, ScaleOfTheObservable) {
  Table table = trial().table;
  change(table, "rate_deg_per_h", [](double v) { return 10.0 * v; });
  change(table, "rate_std_error_deg_per_h", [](double v) { return 10.0 * v; });
  expect_same(reference(), diagnosed_trial(table), 10.0);
}

TEST(DiagnoseInvariance, ColumnsThatNoEffectKnows) {
  Table table = trial().table;
  std::vector<double> pressure(table.rows());
  std::iota(pressure.begin(), pressure.end(), 990.0);
  table.set_column("pressure_hpa", std::move(pressure));
  // It is a cause to be tried like any other, so p-values differ; what is found does not.
  const Diagnosis with = diagnosed_trial(table);
  EXPECT_EQ(name_of(reference().verdict), name_of(with.verdict));
  EXPECT_EQ(reference().ambiguous, with.ambiguous);
  ASSERT_EQ(reference().missing.size(), with.missing.size());
  EXPECT_EQ(reference().missing[0].found.effect, with.missing[0].found.effect);
}

TEST(DiagnoseInvariance, WorkersInTurnOnOneProcessorToTheLastBit) {
  cpu_set_t all, one;
  ASSERT_EQ(sched_getaffinity(0, sizeof all, &all), 0);
  CPU_ZERO(&one);
  for (int cpu = 0; cpu < CPU_SETSIZE && CPU_COUNT(&one) == 0; ++cpu) {
    if (CPU_ISSET(cpu, &all)) CPU_SET(cpu, &one);
  }
  ASSERT_EQ(sched_setaffinity(0, sizeof one, &one), 0);
  const Diagnosis alone = diagnosed_trial(trial().table);
  ASSERT_EQ(sched_setaffinity(0, sizeof all, &all), 0);
  expect_same(reference(), alone);
  EXPECT_EQ(reference().missing[0].found.p_value, alone.missing[0].found.p_value);
  EXPECT_EQ(verdict_in_words(reference(), "").sentences(), verdict_in_words(alone, "").sentences());
}

/// The set that these data cannot tell apart; which of it leads by a hair is a matter of chance.
std::set<std::string> names_of(const MissingEffect& missing) {
  std::set<std::string> out{missing.found.effect};
  for (const Rival& rival : missing.found.rivals) out.insert(rival.effect);
  return out;
}

TEST(DiagnoseInvariance, SeedOfAClearCase) {
  const Diagnosis other = diagnosed_trial(trial().table, {.seed = 7});
  EXPECT_EQ(other.verdict, reference().verdict);
  ASSERT_EQ(other.missing.size(), 1U);
  EXPECT_EQ(names_of(other.missing[0]), names_of(reference().missing[0]));
}

TEST(DiagnoseInvariance, OrderOfTheCatalogue) {
  const tests::Trial given = trial();
  const auto table = WorkingTable::make(given.table, given.model, nullptr);
  ASSERT_TRUE(table);
  const Signals signals(table->fine(), given.model.reference_temperature_c);
  const auto library = make_library({*table, signals, given.model, {}});
  ASSERT_TRUE(library);
  Library permuted = *library;
  std::shuffle(permuted.candidates.begin(), permuted.candidates.end(), std::mt19937_64(9));
  ASSERT_NE(permuted.candidates.front().name, library->candidates.front().name);

  const auto shapes = NoiseShapes::make(table->windows());
  ASSERT_TRUE(shapes);
  const auto column = [&](const char* name) { return signals.signal(name); };
  Eigen::MatrixXd base(table->rows(), 4);
  base << Eigen::VectorXd::Ones(table->rows()), column("field_x_ut"), column("field_y_ut"),
      column("field_z_ut");
  const Eigen::VectorXd y = column("rate_deg_per_h");
  const WhitenedLibrary whitened(*shapes, *library), shuffled(*shapes, permuted);
  const SearchResult one = search({whitened, table->windows(), table->bench_rows(), base, y}, {});
  const SearchResult other = search({shuffled, table->windows(), table->bench_rows(), base, y}, {});
  ASSERT_EQ(one.found.size(), other.found.size());
  ASSERT_FALSE(one.found.empty());
  for (std::size_t i = 0; i < one.found.size(); ++i) {
    EXPECT_EQ(one.found[i].effect, other.found[i].effect);
    EXPECT_EQ(one.found[i].rivals.size(), other.found[i].rivals.size());
    EXPECT_NEAR(one.found[i].p_value, other.found[i].p_value, kRounding * one.found[i].p_value);
  }
  ASSERT_EQ(one.p_of_step.size(), other.p_of_step.size());
  for (std::size_t i = 0; i < one.p_of_step.size(); ++i) {
    EXPECT_NEAR(one.p_of_step[i], other.p_of_step[i], kRounding * one.p_of_step[i]);
  }
  EXPECT_EQ(one.outside_shape, other.outside_shape);
}

}  // namespace
}  // namespace fogbench::model
