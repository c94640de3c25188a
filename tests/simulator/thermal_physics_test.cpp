// Heater, carrier, coil, room and the controller, against what their equations say.

#include "simulator/thermal_physics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "simulator/thermostat_controller.hpp"
#include "tests/simulator/test_bench.hpp"

namespace fogbench::simulator {
namespace {

config::ThermalPlant quiet_plant() {
  config::ThermalPlant plant;
  plant.ambient_wander = config::Celsius{0.0};
  plant.sensor_noise = config::Celsius{0.0};
  return plant;
}

TEST(ThermalPhysics, HoldsThirtyFourDegreesAboveTheRoomWithNineWatts) {
  const config::ThermalPlant plant = quiet_plant();
  ThermalPhysics thermal(plant, 0.1);
  for (int i = 0; i < 600000; ++i) thermal.advance({0.0, 9.0});
  EXPECT_NEAR(thermal.carrier_c(), 21.0 + 9.0 / plant.carrier_ambient_w_per_k, 1e-3);
  EXPECT_GE(thermal.carrier_c(), 21.0 + 34.0);
  EXPECT_NEAR(thermal.heater_c() - thermal.carrier_c(), 9.0 / plant.heater_carrier_w_per_k, 1e-6);
  EXPECT_NEAR(thermal.coil_c(), thermal.carrier_c(), 1e-3);
}

TEST(ThermalPhysics, HeatsAfterTheDeadTimeAndConservesEnergy) {
  config::ThermalPlant plant = quiet_plant();
  plant.carrier_ambient_w_per_k = 0.0;
  ThermalPhysics thermal(plant, 0.1);
  for (int i = 0; i < 100; ++i) thermal.advance({12.0, 0.0});
  EXPECT_EQ(thermal.heater_c(), 21.0);
  for (int i = 0; i < 6000; ++i) thermal.advance({12.0, 0.0});
  const double stored_j = plant.heater_j_per_k * (thermal.heater_c() - 21.0) +
                          plant.carrier_j_per_k * (thermal.carrier_c() - 21.0) +
                          plant.coil_j_per_k * (thermal.coil_c() - 21.0);
  EXPECT_NEAR(stored_j, 12.0 * 600.0, 1e-6 * stored_j);
}

TEST(ThermalPhysics, CoolsWithTheSlowTimeConstantOfItsNodes) {
  config::ThermalPlant plant = quiet_plant();
  plant.heater_carrier_w_per_k = 1e4;  // All nodes as one: the time constant is C/G.
  plant.carrier_coil_w_per_k = 1e3;
  plant.heater_j_per_k = 1e4;
  plant.coil_j_per_k = 1e3;
  plant.dead_time = config::Seconds{0.0};
  ThermalPhysics thermal(plant, 0.1);
  for (int i = 0; i < 20000; ++i) thermal.advance({0.0, 200.0});
  for (int i = 0; i < 100; ++i) thermal.advance({});
  const double start = thermal.carrier_c() - 21.0;
  const double tau_s = (plant.heater_j_per_k + plant.carrier_j_per_k + plant.coil_j_per_k) /
                       plant.carrier_ambient_w_per_k;
  const int steps = static_cast<int>(tau_s / 0.1);
  for (int i = 0; i < steps; ++i) thermal.advance({});
  EXPECT_NEAR((thermal.carrier_c() - 21.0) / start, std::exp(-1.0), 2e-4);
}

TEST(ThermalPhysics, RateAndAccelerationAreTheDerivativesOfTheCarrier) {
  const config::ThermalPlant plant = quiet_plant();
  ThermalPhysics thermal(plant, 0.1);
  for (int i = 0; i < 400; ++i) thermal.advance({12.0, 0.0});
  const double before = thermal.carrier_c();
  thermal.advance({12.0, 0.0});
  const double rate = thermal.carrier_rate_c_per_h();
  const double middle = thermal.carrier_c();
  thermal.advance({12.0, 0.0});
  EXPECT_NEAR(rate, (thermal.carrier_c() - before) / 0.2 * 3600.0, 1e-4 * rate);
  EXPECT_NEAR(thermal.carrier_acceleration_c_per_h2(),
              (thermal.carrier_c() - 2.0 * middle + before) / 0.01 * 3600.0 * 3600.0,
              0.01 * std::abs(thermal.carrier_acceleration_c_per_h2()));
}

TEST(ThermalPhysics, BoostHeatersMakeAGradientAndTheRoomWanders) {
  config::ThermalPlant plant = quiet_plant();
  plant.ambient_wander = config::Celsius{0.3};
  ThermalPhysics thermal(plant, 0.1);
  for (int i = 0; i < 18000; ++i) thermal.advance({12.0, 0.0});  // A quarter of the room's period.
  EXPECT_NEAR(thermal.gradient_c(), 12.0 * plant.gradient_c_per_w, 1e-12);
  EXPECT_NEAR(thermal.ambient_c(), 21.3, 1e-9);
}

TEST(ThermalPhysics, TheGradientLagsWhereThePlantSaysSo) {
  config::ThermalPlant plant = quiet_plant();
  plant.gradient_lag = config::Seconds{100.0};
  plant.dead_time = config::Seconds{0.0};
  ThermalPhysics thermal(plant, 0.1);
  for (int i = 0; i < 1000; ++i) thermal.advance({12.0, 0.0});
  const double settled_c = 12.0 * plant.gradient_c_per_w;
  EXPECT_NEAR(thermal.gradient_c(), settled_c * (1.0 - std::exp(-1.0)), 1e-9);
}

/// Runs the controlled plant and looks at it once a step.
class ThermostatLoop : public ::testing::Test {
 protected:
  void command(config::HeatingMode mode, double target_c) {
    controller_.set_mode(mode);
    controller_.set_target(config::Celsius{target_c});
  }
  template <class Look>
  void run(double seconds, Look look) {
    for (int i = 0; i < static_cast<int>(seconds / kStepS); ++i) {
      thermal_.advance(controller_.power());
      controller_.advance(thermal_);
      look();
    }
  }
  void run(double seconds) {
    run(seconds, [] {});
  }

  static constexpr double kStepS = 0.1;
  config::ThermalPlant plant_;
  ThermalPhysics thermal_{plant_, kStepS};
  ThermostatController controller_{plant_, kStepS, 7};
};

TEST_F(ThermostatLoop, BoostRunsAtTwelveWattsAndDropsOutTwoDegreesBelowTheTarget) {
  command(config::HeatingMode::kBoost, 31.0);
  double dropped_out_c = 0.0;
  bool came_back = false;
  run(3600.0, [&] {
    const HeaterPower& power = controller_.power();
    if (power.boost_w > 0.0) {
      EXPECT_EQ(power.boost_w, 12.0);
      EXPECT_EQ(power.normal_w, 0.0);
      came_back |= dropped_out_c > 0.0;
    } else if (dropped_out_c == 0.0 && power.normal_w > 0.0) {
      dropped_out_c = controller_.sensors_c()[2];
    }
  });
  EXPECT_NEAR(dropped_out_c, 29.0, 0.1);
  EXPECT_FALSE(came_back);
}

TEST_F(ThermostatLoop, SettlesToAllLevelsOfTheProcedureWithoutOvershootOfATenthOfADegree) {
  command(config::HeatingMode::kBoost, 31.0);
  run(2400.0);
  controller_.set_mode(config::HeatingMode::kNormal);
  for (const double target : {31.0, 35.0, 40.0, 45.0, 50.0, 55.0}) {
    controller_.set_target(config::Celsius{target});
    double highest = 0.0;
    run(3000.0, [&] { highest = std::max(highest, thermal_.carrier_c()); });
    EXPECT_LT(highest, target + 0.1) << target;
    double worst = 0.0;
    run(300.0, [&] { worst = std::max(worst, std::abs(thermal_.carrier_c() - target)); });
    EXPECT_LT(worst, 0.02) << target;
    EXPECT_LE(controller_.power().normal_w, 9.0);
  }
}

TEST_F(ThermostatLoop, AnUnreachableTargetDoesNotWindUpTheIntegral) {
  command(config::HeatingMode::kNormal, 75.0);
  run(20000.0);
  EXPECT_EQ(controller_.power().normal_w, 9.0);
  const double reached = thermal_.carrier_c();
  controller_.set_target(config::Celsius{reached - 5.0});
  run(2.0);
  EXPECT_EQ(controller_.power().normal_w, 0.0);
}

TEST_F(ThermostatLoop, OffTakesThePowerAwayAtOnce) {
  command(config::HeatingMode::kBoost, 50.0);
  run(60.0);
  EXPECT_EQ(controller_.power().boost_w, 12.0);
  controller_.set_mode(config::HeatingMode::kOff);
  EXPECT_EQ(controller_.power().total_w(), 0.0);
  run(60.0);
  EXPECT_EQ(controller_.power().total_w(), 0.0);
}

TEST(ThermostatController, SensorsLagAndShowOffsetNoiseAndResolution) {
  config::ThermalPlant plant = quiet_plant();
  plant.sensor_noise = config::Celsius{0.004};
  plant.sensor_resolution = config::Celsius{0.001};
  plant.sensor_offset_c = {0.1, -0.2, 0.3};
  ThermalPhysics thermal(plant, 0.2);
  ThermostatController controller(plant, 0.2, 3);
  constexpr int kSamples = 20000;
  double sum[3] = {};
  double squares = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    thermal.advance({});
    controller.advance(thermal);
    for (std::size_t k = 0; k < 3; ++k) sum[k] += controller.sensors_c()[k] - 21.0;
    const double counts = controller.sensors_c()[0] / 0.001;
    EXPECT_NEAR(counts, std::round(counts), 1e-6);
    squares += std::pow(controller.sensors_c()[0] - 21.1, 2);
  }
  // Five standard errors of a mean of 20000.
  EXPECT_NEAR(sum[0] / kSamples, 0.1, 1.5e-4);
  EXPECT_NEAR(sum[1] / kSamples, -0.2, 1.5e-4);
  EXPECT_NEAR(sum[2] / kSamples, 0.3, 1.5e-4);
  EXPECT_NEAR(std::sqrt(squares / kSamples), std::hypot(0.004, 0.001 / std::sqrt(12.0)), 1e-4);
}

TEST(ThermostatController, ASensorLagsARampByItsTimeConstant) {
  config::ThermalPlant plant = quiet_plant();
  plant.gradient_c_per_w = 0.0;
  plant.carrier_ambient_w_per_k = 0.0;
  ThermalPhysics thermal(plant, 0.1);
  ThermostatController controller(plant, 0.1, 3);
  for (int i = 0; i < 20000; ++i) {
    thermal.advance({0.0, 9.0});
    controller.advance(thermal);
  }
  const double rate_c_per_s = thermal.carrier_rate_c_per_h() / 3600.0;
  EXPECT_NEAR(thermal.carrier_c() - controller.sensors_c()[2],
              rate_c_per_s * plant.sensor_lag.count(), 0.0015);
}

TEST(ThermostatController, AChambersCoolerHoldsATemperatureBelowTheRoom) {
  config::ThermalPlant plant = quiet_plant();
  plant.cooling_maximum = config::Watt{5.0};
  ThermalPhysics thermal(plant, 0.1);
  ThermostatController controller(plant, 0.1, 3);
  controller.set_target(config::Celsius{15.0});
  controller.set_mode(config::HeatingMode::kNormal);
  for (int i = 0; i < 200000; ++i) {
    thermal.advance(controller.power());
    controller.advance(thermal);
  }
  EXPECT_NEAR(thermal.carrier_c(), 15.0, 0.05);
  EXPECT_NEAR(controller.power().cooling_w, 6.0 * plant.carrier_ambient_w_per_k, 0.1);
  EXPECT_EQ(controller.power().total_w(), 0.0) << "no heater is on";
  controller.set_mode(config::HeatingMode::kOff);
  EXPECT_EQ(controller.power().cooling_w, 0.0);
}

}  // namespace
}  // namespace fogbench::simulator
