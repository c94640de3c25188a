// The distance between two explanations, against least squares written out, and the bench on paper
// against its own heat balance.

#include "model/next/separation.hpp"
#include "model/effects/catalogue.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

namespace fogbench::model {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr NoiseCoefficients kWhite{.angle_random_walk_deg_per_sqrt_h = 0.001};

Recorded heating() {
  BenchSchedule bench(21.0);
  bench.heat(Heater::kNormal, 40.0);
  bench.record(1800.0, 60.0, "heating");
  return bench.recorded();
}

VectorXd column(const Recorded& run, const char* name) {
  return VectorXd::Map(run.table.column(name).data(), run.windows.rows());
}

TEST(Separation, IsTheResidualOfTheBestRivalInUnitsOfTheNoise) {
  const Recorded run = heating();
  config::ModelFile model;
  model.terms.emplace_back().effect = "bias";
  const Separation separation(run, model,
                              {find_effect("temperature_rate"), find_effect("heater_power")},
                              {{}, {}}, kWhite, 1);
  const Truth truth{.block = 0, .beta = VectorXd::Constant(1, 0.003)};

  MatrixXd rival(run.windows.rows(), 2);
  rival << VectorXd::Ones(run.windows.rows()), column(run, "heater_w");
  const VectorXd signal = 0.003 * column(run, "temperature_rate_c_per_h");
  const VectorXd left = signal - rival * rival.colPivHouseholderQr().solve(signal);
  const double sigma = 0.001 / std::sqrt(60.0 / 3600.0);
  EXPECT_NEAR(separation.squared(separation.present(), 0, truth, 1),
              left.squaredNorm() / (sigma * sigma), 1e-6 * left.squaredNorm() / (sigma * sigma));
}

TEST(Separation, TheSameRunAgainDoublesTheSquare) {
  const Recorded run = heating();
  config::ModelFile model;
  model.terms.emplace_back().effect = "magnetic_linear_x";  // no bias, which each run has anew
  const Separation separation(run, model,
                              {find_effect("temperature_rate"), find_effect("heater_power")},
                              {{}, {}}, kWhite, 1);
  const Truth truth{.block = 0, .beta = VectorXd::Constant(1, 0.003)};
  const double once = separation.squared(separation.present(), 0, truth, 1);
  EXPECT_GT(once, 1.0);
  EXPECT_NEAR(separation.squared(separation.with(run), 0, truth, 1), 2.0 * once, 1e-6 * once);
}

TEST(Separation, AnEffectIsAtNoDistanceFromItself) {
  const Recorded run = heating();
  config::ModelFile model;
  model.terms.emplace_back().effect = "bias";
  const Separation separation(run, model, {find_effect("warm_up"), find_effect("warm_up")},
                              {{900.0}, {900.0}}, kWhite, 5);
  const Truth truth{.block = 0, .beta = VectorXd::Constant(1, 0.5)};
  EXPECT_GT(separation.squared(separation.present(), 0, truth), 100.0);
  EXPECT_NEAR(separation.squared(separation.present(), 0, truth, 1), 0.0, 1e-6);
}

TEST(Separation, NoisesSeparateWithTheLengthOfTheRecord) {
  NoiseCoefficients walk = kWhite;
  walk.rate_random_walk_deg_per_h_per_sqrt_h = 0.01;
  EXPECT_NEAR(squared_noise_separation(4.0, walk, walk), 0.0, 1e-9);
  const double short_record = squared_noise_separation(0.1, kWhite, walk);
  const double long_record = squared_noise_separation(4.0, kWhite, walk);
  EXPECT_GT(short_record, 0.0);
  EXPECT_GT(long_record, 5.0 * short_record);
}

TEST(BenchSchedule, HoldsATemperatureWithThePowerThatTheFoamLosesThere) {
  BenchSchedule bench(21.0);
  bench.heat(Heater::kNormal, 41.0);
  bench.settle(0.0, "");
  bench.wait(3600.0);
  bench.record(60.0, 60.0, "plateau");
  const Recorded run = bench.recorded();
  EXPECT_NEAR(column(run, "temperature_c")[0], 41.0, 0.1);
  EXPECT_NEAR(column(run, "heater_w")[0], 0.22 * 20.0, 0.3);  // the room wanders by 0.3 degC
  EXPECT_NEAR(column(run, "temperature_rate_c_per_h")[0], 0.0, 0.5);
}

TEST(BenchSchedule, TheRecordedRateIsTheSlopeOfTheRecordedTemperature) {
  const Recorded run = heating();
  const VectorXd t = column(run, "temperature_c"), rate = column(run, "temperature_rate_c_per_h");
  for (Eigen::Index i = 2; i + 1 < t.size(); ++i) {
    EXPECT_NEAR((t[i + 1] - t[i - 1]) / 2.0 * 60.0, rate[i], 1.5) << i;
  }
  EXPECT_EQ(run.hours, 0.5);
}

TEST(BenchSchedule, TurnsWithoutFieldAndNamesTheBranches) {
  BenchSchedule bench(21.0);
  bench.sweep('z', {0.0, 100.0, 0.0}, 60.0, 2);
  bench.turn(90.0);
  bench.record(60.0, 60.0, "coil/baseline");
  const Recorded run = bench.recorded();
  EXPECT_THAT(column(run, "field_z_ut"), testing::ElementsAre(0, 0, 100, 100, 0, 0, 0));
  EXPECT_THAT(column(run, "azimuth_deg"), testing::ElementsAre(0, 0, 0, 0, 0, 0, 90));
  EXPECT_EQ(run.table.segment().at(2), "coil_z/up");
  EXPECT_EQ(run.table.segment().at(4), "coil_z/down");
}

}  // namespace
}  // namespace fogbench::model
