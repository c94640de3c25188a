// The study of the diagnosis rests on this simulator: its noise must have the covariance that it
// states, and an effect the signal-to-noise ratio that was asked for.

#include "tests/support/foreign_bench.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <set>

#include "model/effects/catalogue.hpp"
#include "model/table/signals.hpp"

namespace fogbench::tests {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

class ForeignNoiseKind : public testing::TestWithParam<std::string> {};

TEST_P(ForeignNoiseKind, DrawsHaveTheStatedCovariance) {
  const ForeignNoise noise = foreign_noise(GetParam());
  const World world = make_worlds(Design::kOneAxis).front();
  const MatrixXd stated = noise_covariance(noise, world);
  const Eigen::LLT<MatrixXd> factor(stated);
  ASSERT_EQ(factor.info(), Eigen::Success);
  std::mt19937_64 engine(7);
  constexpr int kDraws = 1500;
  MatrixXd whitened = MatrixXd::Zero(stated.rows(), stated.rows());
  for (int i = 0; i < kDraws; ++i) {
    const VectorXd u = factor.matrixL().solve(draw_noise(noise, world, engine));
    whitened += u * u.transpose() / kDraws;
  }
  // Of unit normals: entries off the diagonal have a deviation of 1/sqrt(draws), 0.026, those on it
  // sqrt(2) of that, more with long tails. Of 325 entries none is five deviations off.
  const MatrixXd error = whitened - MatrixXd::Identity(stated.rows(), stated.rows());
  EXPECT_LT(error.cwiseAbs().maxCoeff(), noise.tails > 0.0 ? 0.35 : 0.19);
}

INSTANTIATE_TEST_SUITE_P(All, ForeignNoiseKind,
                         testing::Values("white", "flicker", "walk", "fractional", "markov",
                                         "interference", "tails", "swing", "quantised"),
                         [](const auto& kind) { return kind.param; });

TEST(ForeignBench, AnEffectIsPutInAtTheRatioAskedFor) {
  const ForeignBench bench(Design::kMagnetic, foreign_noise("navigation"),
                           usual_base(Design::kMagnetic));
  const ForeignEffect effect = bench.at_ratio({.id = "magnetic_quadratic_z"}, 12.0);
  EXPECT_NEAR(bench.signal_to_noise(effect), 12.0, 1e-9);
  // The best estimate of its amplitude is then 12 of its own standard errors from zero.
  VectorXd direction = bench.clear_in_noise(bench.column(effect)).normalized();
  double sum = 0.0, squares = 0.0;
  constexpr int kTables = 200;
  for (int i = 0; i < kTables; ++i) {
    const model::Table table = bench.table({effect}, {}, 100 + static_cast<std::uint64_t>(i));
    const auto rate = table.column("rate_deg_per_h");
    const Eigen::Map<const VectorXd> y(rate.data(), static_cast<Index>(rate.size()));
    const double z = direction.dot(bench.clear_in_noise(y).col(0));
    sum += z;
    squares += z * z;
  }
  const double mean = sum / kTables;
  EXPECT_NEAR(mean, 12.0, 0.3);  // four deviations of a mean of 200
  EXPECT_NEAR(std::sqrt(squares / kTables - mean * mean), 1.0, 0.2);
}

TEST(ForeignBench, EveryEffectOfWhatItRecordsHasAForeignEquationThatSomeDesignExcites) {
  const ForeignBench bench(Design::kMixed, foreign_noise("navigation"), usual_base(Design::kMixed));
  const model::Table table = bench.table({}, {}, 1);
  const model::Signals signals(table, kLaboratory);
  std::set<std::string> asked, excited{"bias"};
  for (const model::Effect* effect : model::catalogue()) {
    if (signals.missing_for(effect->info()).empty()) asked.insert(effect->info().id);
  }
  EXPECT_GE(asked.size(), 43U);
  for (const Design design : {Design::kMagnetic, Design::kDiagonals, Design::kMixed}) {
    std::mt19937_64 engine(3);
    const World world = make_worlds(design).front();
    for (const std::string& id : asked) {
      const Series g = regressor(world, drawn_effect(id, Shape::kOwn, world, engine));
      for (const double v : g) ASSERT_TRUE(std::isfinite(v)) << id;
      if (std::set<double>(g.begin(), g.end()).size() > 1) excited.insert(id);
    }
  }
  EXPECT_EQ(excited, asked);
}

TEST(ForeignBench, OtherShapesDifferFromTheCataloguesAndStayNearThem) {
  const ForeignBench bench(Design::kMixed, foreign_noise("navigation"), usual_base(Design::kMixed));
  for (const std::string& id : other_shapes()) {
    std::mt19937_64 engine(5);
    ForeignEffect effect = drawn_effect(id, Shape::kOwn, bench.worlds().front(), engine);
    const VectorXd own = bench.column(effect);
    effect.shape = Shape::kOther;
    const VectorXd other = bench.column(effect);
    const double cosine = own.dot(other) / (own.norm() * other.norm());
    EXPECT_LT(cosine, 1.0 - 1e-7) << id;
    EXPECT_GT(cosine, 0.5) << id;
  }
}

TEST(ForeignBench, TheSameSeedGivesTheSameTableAndAnotherAnother) {
  const ForeignBench bench(Design::kTwoRuns, foreign_noise("tactical"),
                           usual_base(Design::kTwoRuns));
  const model::Table a = bench.table({}, {}, 1), b = bench.table({}, {}, 1),
                     c = bench.table({}, {}, 2);
  ASSERT_EQ(a.rows(), 150U);
  EXPECT_EQ(a.run().values.size(), 2U);
  for (std::size_t row = 0; row < a.rows(); ++row) {
    EXPECT_EQ(a.column("rate_deg_per_h")[row], b.column("rate_deg_per_h")[row]);
    EXPECT_NE(a.column("rate_deg_per_h")[row], c.column("rate_deg_per_h")[row]);
  }
}

TEST(ForeignBench, ColumnsThatAreNotWantedAreNotWritten) {
  const ForeignBench bench(Design::kOneAxis, foreign_noise("white"), usual_base(Design::kOneAxis));
  const model::Table table = bench.table({}, {.standard_error = false, .heater = false}, 1);
  EXPECT_FALSE(table.has("rate_std_error_deg_per_h"));
  EXPECT_FALSE(table.has("heater_w"));
  EXPECT_TRUE(table.has("ambient_c"));
}

TEST(ForeignBench, AStaticRecordHoldsNothingButNoise) {
  const model::Table table = static_record(foreign_noise("white"), 2.0, 4);
  ASSERT_EQ(table.rows(), 120U);
  EXPECT_EQ(table.segment().at(0), "static");
  for (const double v : table.column("field_z_ut")) EXPECT_NEAR(v, 0.0, 0.1);
}

}  // namespace
}  // namespace fogbench::tests
