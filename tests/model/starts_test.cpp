// Every memory has a beginning that nobody recorded: tables that are cut out of longer ones, so
// that a lag does not begin settled and a play not in the middle of its band.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>

#include "model/effects/catalogue.hpp"
#include "model/fit/compensate.hpp"
#include "model/fit/fit.hpp"
#include "tests/model/cut_out_chamber.hpp"

namespace fogbench::model {
namespace {

/// What least squares on the effect's column and its starts leaves of the column of a memory that
/// is older than the table.
double left_of(const std::string& id, double inner, std::size_t first) {
  const Table whole = chamber(7.0);
  const Table table = rows_of(whole, first);
  const Effect& effect = *find_effect(id);
  const Signals all(whole, 21.0), some(table, 21.0);
  const Eigen::VectorXd truth = effect.regressor(all, std::vector{inner})
                                    .col(0)
                                    .tail(static_cast<Eigen::Index>(table.rows()));
  const Eigen::VectorXd own = effect.regressor(some, std::vector{inner}).col(0);
  const Eigen::MatrixXd starts = effect.starts(some, std::vector{inner});
  const Eigen::VectorXd coefficients =
      Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>(starts).solve(truth - own);
  EXPECT_LE(coefficients.cwiseAbs().maxCoeff(), 1.5) << "beyond what physics allows";
  EXPECT_GT((truth - own).cwiseAbs().maxCoeff(), 0.5) << "the cut changes nothing";
  return (truth - own - starts * coefficients).cwiseAbs().maxCoeff();
}

TEST(Starts, ALagThatWasCutOffIsItsOwnColumnAndAStart) {
  EXPECT_LT(left_of("temperature_rate_lagged", 800.0, 60), 1e-9);
}

TEST(Starts, APlayThatWasCutOffIsItsOwnColumnAndStartsToASixthOfItsWidth) {
  for (const std::size_t first : {50u, 58u, 66u, 70u}) {
    EXPECT_LT(left_of("temperature_hysteresis", 4.0, first), 4.0 / 6.0) << first;
  }
}

TEST(Starts, EachRunAndEachGapBeginsAnew) {
  const Table whole = chamber(4.0);
  const Effect& effect = *find_effect("temperature_rate_lagged");
  const auto starts_in = [&](const Table& table) {
    return effect.starts(Signals(table, 21.0), std::vector{300.0}).cols();
  };
  EXPECT_EQ(starts_in(whole), 1);
  EXPECT_EQ(starts_in(rows_of(whole, 0, 40, 42)), 2);
  Table runs = whole;
  std::vector<std::uint32_t> run(whole.rows(), 0);
  std::fill(run.begin() + 70, run.end(), 1);
  runs.set_run({{"1", "2"}, run});
  EXPECT_EQ(starts_in(runs), 2);
}

// More than a dozen rows are missing: they are by intent, and nothing was forgotten.
TEST(Starts, SparseRowsAreNoGaps) {
  const Table whole = chamber(4.0);
  std::vector<bool> keep(whole.rows());
  for (std::size_t row = 0; row < keep.size(); row += row % 10 == 9 ? 4 : 1) keep[row] = true;
  const Table sparse = whole.select(keep);
  const Effect& effect = *find_effect("temperature_hysteresis");
  const Eigen::Index of_one_run = effect.starts(Signals(whole, 21.0), std::vector{2.0}).cols();
  EXPECT_EQ(effect.starts(Signals(sparse, 21.0), std::vector{2.0}).cols(), of_one_run);
}

TEST(Starts, AFitFindsTheCoefficientWhereverTheMemoryBegan) {
  const config::ModelFile truth = lagged_world();
  const Table table = cut_out(truth, 6.0, 60, 0.004, 11);
  const auto found =
      fit(table, model_of_effects({"bias", "temperature_linear", "temperature_rate_lagged"}), {});
  ASSERT_TRUE(found) << found.error().message;
  const double expected[] = {0.4, 0.003, 0.017, 800.0};
  ASSERT_EQ(found->estimates.size(), 4U) << "the start is no part of the model";
  for (std::size_t i = 0; i < 4; ++i) {
    const Estimate& e = found->estimates[i];
    EXPECT_LT(std::abs(e.value - expected[i]), 4.0 * e.standard_error) << e.name;
  }
  EXPECT_NEAR(found->estimates[2].value, 0.017, 0.0005);
  EXPECT_NEAR(found->rms, 0.004, 0.0006);
}

TEST(Starts, GivenCoefficientsAreHeldAndTheBeginningIsFoundAllTheSame) {
  const config::ModelFile truth = lagged_world();
  const Table table = cut_out(truth, 6.0, 60, 0.004, 12);
  const auto held = fit(table, truth, {.as_is = true});
  ASSERT_TRUE(held) << held.error().message;
  EXPECT_NEAR(held->rms, 0.004, 0.0006);
  const auto compensated = compensate(table, truth);
  ASSERT_TRUE(compensated) << compensated.error().message;
  EXPECT_NEAR(compensated->rms_after, 0.004, 0.0006);
}

}  // namespace
}  // namespace fogbench::model
