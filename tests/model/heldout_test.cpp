#include "model/diagnose/heldout.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

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
  EXPECT_EQ(votes.at(0).better, 0);
  EXPECT_EQ(votes.at(0).gain, 0.0);
}

TEST(HeldoutVotes, WithoutKnownNoiseThereIsNone) {
  EXPECT_TRUE(heldout_votes(minutes(kMinutes), {}, Eigen::MatrixXd::Ones(kMinutes, 1),
                            {Eigen::MatrixXd(kMinutes, 0)}, unit_normals(9), kMinutes)
                  .empty());
}

}  // namespace
}  // namespace fogbench::model
