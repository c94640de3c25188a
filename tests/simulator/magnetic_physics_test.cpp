// Geometry of coils and rotation, the supply's steps, disturbances.

#include "simulator/magnetic_physics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/simulator/test_bench.hpp"

namespace fogbench::simulator {
namespace {

using Pair = MagneticPhysics::Pair;

config::MagneticPlant still_plant() {
  config::MagneticPlant plant;
  plant.ambient_diurnal = config::Microtesla{0.0};
  return plant;
}

TEST(MagneticPhysics, EachPairMakesItsFieldPerAmpereAlongItsTiltedAxis) {
  config::MagneticPlant plant = still_plant();
  plant.ambient_ut = {0.0, 0.0, 0.0};
  plant.coil_ut_per_a = {90.0, 80.0};
  plant.coil_misalignment_deg = {0.3, 1.0};
  const double rad = std::numbers::pi / 180.0;

  MagneticPhysics magnetic(plant, 0.1, 1);
  magnetic.program(Pair::kHorizontal, 2.0, 0.0);
  magnetic.advance();
  Vector3 field = magnetic.field_ut();
  EXPECT_NEAR(field[0], 180.0 * std::cos(0.3 * rad), 1e-9);
  EXPECT_NEAR(field[1], 180.0 * std::sin(0.3 * rad), 1e-9);
  EXPECT_NEAR(field[2], 0.0, 1e-9);

  magnetic.program(Pair::kHorizontal, 0.0, 0.0);
  magnetic.program(Pair::kVertical, -3.0, 0.0);
  magnetic.advance();
  field = magnetic.field_ut();
  EXPECT_NEAR(field[0], 0.0, 1e-9);
  EXPECT_NEAR(field[1], -240.0 * std::cos(1.0 * rad), 1e-9);
  EXPECT_NEAR(field[2], -240.0 * std::sin(1.0 * rad), 1e-9);
  EXPECT_DOUBLE_EQ(magnetic.sum_squared_current_a2(), 9.0);
}

TEST(MagneticPhysics, TheCurrentFollowsWithItsTimeConstant) {
  MagneticPhysics magnetic(still_plant(), 0.1, 1);
  magnetic.program(Pair::kVertical, 1.0, 0.5);
  for (int i = 0; i < 5; ++i) magnetic.advance();
  EXPECT_NEAR(magnetic.current_a(Pair::kVertical), 1.0 - std::exp(-1.0), 1e-12);
}

TEST(MagneticPhysics, YPointsNorthAtAzimuthZeroAndZAtNinety) {
  const Vector3 field{-50.0, 16.0, 1.0};
  Vector3 gyro = to_gyro_axes(field, 0.0);
  EXPECT_NEAR(gyro[0], -50.0, 1e-12);
  EXPECT_NEAR(gyro[1], 16.0, 1e-12);
  EXPECT_NEAR(gyro[2], -1.0, 1e-12);  // Z points west.
  gyro = to_gyro_axes(field, 90.0);
  EXPECT_NEAR(gyro[0], -50.0, 1e-12);
  EXPECT_NEAR(gyro[1], 1.0, 1e-12);
  EXPECT_NEAR(gyro[2], 16.0, 1e-12);
}

TEST(MagneticPhysics, RotationKeepsLengthsAndAnglesAndHandedness) {
  // Columns are the images of up, north, east; up x north = west is Z at azimuth 0.
  for (const double azimuth : {0.0, 33.0, 90.0, 211.0}) {
    const Vector3 up = to_gyro_axes({1, 0, 0}, azimuth);
    const Vector3 north = to_gyro_axes({0, 1, 0}, azimuth);
    const Vector3 west = to_gyro_axes({0, 0, -1}, azimuth);
    EXPECT_NEAR(std::hypot(north[0], north[1], north[2]), 1.0, 1e-12);
    EXPECT_NEAR(north[1] * west[1] + north[2] * west[2], 0.0, 1e-12);
    EXPECT_NEAR(north[1] * west[2] - north[2] * west[1], up[0], 1e-12);
  }
}

TEST(MagneticPhysics, SupplyCurrentsAreStepsOfFifteenBits) {
  const double lsb = 4.0 / 32768.0;
  EXPECT_DOUBLE_EQ(quantise_current(1.0, 4.0, 15.0), 1.0);
  EXPECT_DOUBLE_EQ(quantise_current(1.4 * lsb, 4.0, 15.0), lsb);
  EXPECT_DOUBLE_EQ(quantise_current(-1.6 * lsb, 4.0, 15.0), -2.0 * lsb);
}

TEST(MagneticPhysics, LiftsMoveTheFieldByTheirSizeAndAsOftenAsConfigured) {
  config::MagneticPlant plant = still_plant();
  plant.ambient_steps_per_h = 6.0;
  plant.ambient_step = config::Microtesla{2.0};
  MagneticPhysics magnetic(plant, 1.0, 4);
  Vector3 before = magnetic.field_ut();
  int changes = 0;
  constexpr int kHours = 200;
  for (int i = 0; i < kHours * 3600; ++i) {
    magnetic.advance();
    const Vector3 now = magnetic.field_ut();
    if (now != before) {
      ++changes;
      EXPECT_NEAR(std::hypot(now[0] + 50.0, now[1] - 16.0, now[2] - 1.0), 2.0, 1e-9);
    }
    before = now;
  }
  // A Poisson count of mean 1200: within four standard deviations.
  EXPECT_NEAR(changes, 6 * kHours, 4.0 * std::sqrt(6.0 * kHours));
}

TEST(MagneticPhysics, TheDailyChangeIsAlongNorth) {
  config::MagneticPlant plant;
  plant.ambient_diurnal = config::Microtesla{0.05};
  MagneticPhysics magnetic(plant, 1.0, 1);
  for (int i = 0; i < 21600; ++i) magnetic.advance();
  EXPECT_NEAR(magnetic.field_ut()[1], 16.05, 1e-9);
  EXPECT_NEAR(magnetic.field_ut()[0], -50.0, 1e-9);
}

TEST(Plant, TurnsAtItsSpeedAndItsMagnetometerTurnsWithIt) {
  config::BenchConfig bench = test_bench();
  bench.simulation.turntable_repeatability = config::Degree{0.003};
  TestPlant test(bench);
  test.run_for(1.0);
  test.plant.rotate_to(90.0);
  test.run_for(10.0);
  EXPECT_NEAR(test.plant.encoder_deg(), 45.0, 1.0);
  test.run_for(10.5);
  EXPECT_DOUBLE_EQ(test.plant.encoder_deg(), 90.0);
  EXPECT_NE(test.plant.state().azimuth_deg, 90.0);
  EXPECT_NEAR(test.plant.state().azimuth_deg, 90.0, 5 * 0.003);
  EXPECT_NEAR(test.plant.field_ut()[2], 16.0, 0.01);
}

TEST(Plant, RefusesAStepThatItCannotIntegrate) {
  drivers::VirtualClock clock;
  for (const double step : {0.0, -0.1, 1.5, std::nan("")}) {
    config::BenchConfig bench = test_bench();
    bench.simulation.step = config::Seconds{step};
    const auto plant = Plant::create(bench, {}, 1, clock);
    ASSERT_FALSE(plant);
    EXPECT_EQ(plant.error().code, ErrorCode::kBadInput);
  }
}

}  // namespace
}  // namespace fogbench::simulator
