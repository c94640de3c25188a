#include "model/diagnose/heldout.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "model/effects/catalogue.hpp"
#include "tests/model/models.hpp"

namespace fogbench::model {
namespace {

constexpr Eigen::Index kMinutes = 80;
constexpr NoiseCoefficients kNoise{.angle_random_walk_deg_per_sqrt_h = 0.001,
                                   .bias_instability_deg_per_h = 0.002};

Windows minutes(Eigen::Index rows) {
  Windows w;
  w.run_begin = {0, static_cast<std::size_t>(rows)};
  w.centre_s = Eigen::VectorXd::LinSpaced(rows, 30.0, 30.0 + 60.0 * static_cast<double>(rows - 1));
  w.duration_s = Eigen::VectorXd::Constant(rows, 60.0);
  w.white_floor = Eigen::VectorXd::Zero(rows);
  return w;
}

Eigen::VectorXd unit_normals(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  return Eigen::VectorXd::NullaryExpr(kMinutes, [&] { return normal(random); });
}

Eigen::MatrixXd joined(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  Eigen::MatrixXd out(a.rows(), a.cols() + 1);
  out << a, b;
  return out;
}

TEST(HeldoutVotes, EveryPartIsPredictedBetterWithWhatIsThere) {
  const Eigen::MatrixXd bias = Eigen::MatrixXd::Ones(kMinutes, 1);
  const Eigen::VectorXd wave = Eigen::VectorXd::LinSpaced(kMinutes, 0.0, 60.0).array().sin();
  const auto whitener = make_whitener(minutes(kMinutes), kNoise);
  const Eigen::VectorXd noise = (*whitener)->colour(unit_normals(1));
  const auto votes = heldout_votes(minutes(kMinutes), kNoise, joined(bias, wave), {bias},
                                   0.1 * wave + noise, kMinutes);
  ASSERT_EQ(votes.size(), 1U);
  EXPECT_EQ(votes[0].folds, 8);
  EXPECT_EQ(votes[0].better, 8);
  EXPECT_GT(votes[0].gain, 100.0);
}

// A useless column costs about one unit of the weighted sum of squares: 200 tables, the mean gain
// is known to 0.15.
TEST(HeldoutVotes, AUselessColumnCosts) {
  const Eigen::MatrixXd bias = Eigen::MatrixXd::Ones(kMinutes, 1);
  const auto whitener = make_whitener(minutes(kMinutes), kNoise);
  double gain = 0.0;
  constexpr int kTables = 200;
  for (std::uint64_t table = 0; table < kTables; ++table) {
    const Eigen::VectorXd noise = (*whitener)->colour(unit_normals(1000 + table));
    gain += heldout_votes(minutes(kMinutes), kNoise, joined(bias, unit_normals(5000 + table)),
                          {bias}, noise, kMinutes)
                .at(0)
                .gain /
            kTables;
  }
  EXPECT_LT(gain, -0.5);
  EXPECT_GT(gain, -2.0);
}

// The same by hand: with independent errors a left-out block is predicted by the others' fit alone.
TEST(HeldoutVotes, IsWhatARefitWithoutTheBlockPredicts) {
  const NoiseCoefficients white{.angle_random_walk_deg_per_sqrt_h = 0.001};
  const double sigma = 0.001 / std::sqrt(60.0 / 3600.0);
  const Eigen::VectorXd y = sigma * unit_normals(21);
  Eigen::MatrixXd x(kMinutes, 2);
  x << Eigen::VectorXd::Ones(kMinutes), unit_normals(22);
  double expected = 0.0;
  for (Eigen::Index fold = 0; fold < 8; ++fold) {
    std::vector<Eigen::Index> left, kept;
    for (Eigen::Index i = 0; i < kMinutes; ++i) {
      (i * 24 / kMinutes % 8 == fold ? left : kept).push_back(i);
    }
    const auto cost = [&](const Eigen::MatrixXd& columns) {
      const Eigen::VectorXd beta =
          columns(kept, Eigen::all).householderQr().solve(y(kept).eval()).eval();
      return (y(left) - columns(left, Eigen::all) * beta).squaredNorm() / (sigma * sigma);
    };
    expected += cost(x.leftCols(1)) - cost(x);
  }
  const auto votes =
      heldout_votes(minutes(kMinutes), white, x, {Eigen::MatrixXd(x.leftCols(1))}, y, kMinutes);
  EXPECT_NEAR(votes.at(0).gain, expected, 1e-6);
}

TEST(HeldoutVotes, WhatOneBlockAloneShowsHasNoVoteThere) {
  const Eigen::MatrixXd bias = Eigen::MatrixXd::Ones(kMinutes, 1);
  Eigen::VectorXd pulse = Eigen::VectorXd::Zero(kMinutes);
  pulse[41] = 1.0;
  const auto votes =
      heldout_votes(minutes(kMinutes), kNoise, joined(bias, pulse), {bias}, pulse, kMinutes);
  EXPECT_EQ(votes.at(0).folds, 7);
}

TEST(HeldoutVotes, AStaticRecordIsNeverLeftOut) {
  // The level is known from the static record alone: were it left out, some fold would have no
  // vote.
  Eigen::VectorXd level = Eigen::VectorXd::Zero(kMinutes);
  level.tail(20).setOnes();
  const auto votes = heldout_votes(minutes(kMinutes), kNoise, level, {Eigen::MatrixXd(kMinutes, 0)},
                                   unit_normals(7), kMinutes - 20);
  EXPECT_EQ(votes.at(0).folds, 8);
}

// A term that next to nothing excites outside one block: its coefficient, from the other rows,
// would miss that block by hundreds of sigma.
TEST(HeldoutRms, IsNotThatOfABlockWhichAloneExcitesATerm) {
  const NoiseCoefficients white{.angle_random_walk_deg_per_sqrt_h = 0.001};
  const double sigma = 0.001 / std::sqrt(60.0 / 3600.0);
  Eigen::MatrixXd x(kMinutes, 2);
  x << Eigen::VectorXd::Ones(kMinutes), 1e-3 * unit_normals(31);
  x.col(1).segment(40, 3).setConstant(1.0);
  const Eigen::VectorXd y = sigma * unit_normals(32);
  const double rms = heldout_rms(minutes(kMinutes), white, x, y, kMinutes);
  EXPECT_GT(rms, 0.8 * sigma);
  EXPECT_LT(rms, 1.4 * sigma);
}

// Any order of terms, any of the catalogue, on tables of noise: each term more leaves no more.
TEST(LeastSquaresRms, NeverRisesWithATermMore) {
  const std::vector<std::string> effects{
      "bias",      "magnetic_linear_z",     "magnetic_hysteresis_z", "magnetic_settling_z",
      "bias_step", "magnetic_saturation_z", "magnetic_quadratic_z",  "drift_linear",
      "warm_up",   "coil_heating"};
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Table table = noisy_loops(kNoise, seed, 1 + static_cast<int>(seed % 3), 0.0);
    std::vector<std::string> order = effects;
    std::shuffle(order.begin(), order.end(), std::mt19937_64(seed));
    config::ModelFile model = model_of_effects({order[0]});
    double before = std::numeric_limits<double>::infinity();
    for (const std::string& effect : order) {
      if (effect != order[0]) model.terms.push_back(term(effect));
      for (const InnerParameter& inner : find_effect(effect)->info().parameters) {
        // Ends of the ranges too, where columns become each other.
        const double place = 0.5 * (seed % 3);
        model.terms.back().parameters[std::string(inner.name)] =
            inner.within.empty() ? inner.minimum + place * (inner.maximum - inner.minimum)
                                 : 2500.0 * (1.0 + place);
      }
      const double after = least_squares_rms(table, model);
      EXPECT_LE(after, before * (1.0 + 1e-9)) << seed << " " << effect;
      before = after;
    }
  }
}

TEST(HeldoutVotes, WithoutKnownNoiseThereIsNone) {
  EXPECT_TRUE(heldout_votes(minutes(kMinutes), {}, Eigen::MatrixXd::Ones(kMinutes, 1),
                            {Eigen::MatrixXd(kMinutes, 0)}, unit_normals(9), kMinutes)
                  .empty());
}

}  // namespace
}  // namespace fogbench::model
