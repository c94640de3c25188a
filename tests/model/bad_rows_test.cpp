#include "model/table/bad_rows.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "model/compare/compare.hpp"
#include "tests/model/models.hpp"

namespace fogbench::model {
namespace {

using testing::HasSubstr;

const config::ModelFile kOneAxis = model_of_effects({"bias", "magnetic_linear_z"});

Table with_row_off(Table table, std::size_t row, double off) {
  const auto given = table.column("rate_deg_per_h");
  std::vector<double> rate(given.begin(), given.end());
  rate[row] += off;
  table.set_column("rate_deg_per_h", std::move(rate));
  return table;
}

double sigma_of(const Table& loops) {
  return loops.column("rate_std_error_deg_per_h").front();
}

TEST(BadRows, AreLeftOutOfAFitAndNamed) {
  const Table loops = noisy_loops(kNavigation, 2, 3, 0.0);
  for (const double sigmas : {12.0, 100.0}) {
    const auto result = fit(with_row_off(loops, 30, sigmas * sigma_of(loops)), kOneAxis, {});
    ASSERT_TRUE(result) << result.error().message;
    ASSERT_EQ(result->left_out.size(), 1u) << sigmas;
    EXPECT_EQ(result->left_out[0].row, 30u);
    EXPECT_NEAR(result->left_out[0].off, sigmas * sigma_of(loops), 4.0 * sigma_of(loops));
    EXPECT_EQ(result->rows.size(), loops.rows() - 1);
    EXPECT_THAT(result->left_out[0].says, HasSubstr("Row 31 (time 6090 s, segment coil_z/"));
    EXPECT_THAT(result->warnings, testing::Contains(HasSubstr("is left out")));
  }
}

TEST(BadRows, AreNoEffectToAComparison) {
  const Table loops = noisy_loops(kNavigation, 2, 3, 0.0);
  const auto spoilt = compare(with_row_off(loops, 30, 100.0 * sigma_of(loops)), kOneAxis, {});
  const auto without = compare(with_row_off(loops, 30, kMissing), kOneAxis, {});
  ASSERT_TRUE(spoilt && without);
  // Believed, it alone would make this less than 0.0001.
  EXPECT_NEAR(spoilt->p_adequate, without->p_adequate, 1e-3 * without->p_adequate)
      << spoilt->looks_like;
}

TEST(BadRows, DoNotChangeWhatTheOthersSay) {
  const Table loops = noisy_loops(kNavigation, 2, 3, 0.0);
  const auto clean = fit(loops, kOneAxis, {});
  const auto spoilt = fit(with_row_off(loops, 30, 100.0 * sigma_of(loops)), kOneAxis, {});
  ASSERT_TRUE(clean && spoilt);
  EXPECT_NEAR(spoilt->estimates[1].value, clean->estimates[1].value,
              clean->estimates[1].standard_error);
}

TEST(BadRows, AreNotAStepOrAStretch) {
  Table loops = noisy_loops(kNavigation, 4, 3, 0.0);
  const double sigma = sigma_of(loops);
  Table step = loops, stretch = loops;
  for (std::size_t i = 40; i < loops.rows(); ++i) step = with_row_off(step, i, 30.0 * sigma);
  for (std::size_t i = 40; i < 44; ++i) stretch = with_row_off(stretch, i, 30.0 * sigma);
  EXPECT_TRUE(fit(step, kOneAxis, {})->left_out.empty());
  EXPECT_TRUE(fit(stretch, kOneAxis, {})->left_out.empty());
}

TEST(BadRows, AreRareInNoise) {
  int found = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    found += fit(noisy_loops(kTactical, seed, 3, 0.0), kOneAxis, {})->left_out.empty() ? 0 : 1;
  }
  EXPECT_EQ(found, 0);
}

TEST(BadRows, AreNotLookedForWhereNobodyAsks) {
  const Table loops = noisy_loops(kNavigation, 2, 3, 0.0);
  const Table spoilt = with_row_off(loops, 30, 100.0 * sigma_of(loops));
  EXPECT_TRUE(fit(spoilt, kOneAxis, {.weight_by = {}, .doubt_rows = false})->left_out.empty());
  EXPECT_EQ(fit(spoilt, kOneAxis, {.weight_by = {}, .leave_out = {3, 4}})->rows.size(),
            loops.rows() - 3);
}

TEST(BadRows, OfAHeldModelStayInTheComparison) {
  config::ModelFile held = kOneAxis;
  held.terms[0].coefficient = 0.5;
  held.terms[1].coefficient = 0.25;
  const Table loops = noisy_loops(kNavigation, 2, 3, 0.0);
  const auto result =
      compare(with_row_off(loops, 30, 100.0 * sigma_of(loops)), held, {.as_is = true});
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(result->fit.rows.size(), loops.rows());
}

}  // namespace
}  // namespace fogbench::model
