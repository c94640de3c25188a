// The real drivers on the far ends, with the ready bench's own files.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "config/bench.hpp"
#include "drivers/open_bench.hpp"
#include "drivers/safe_state.hpp"
#include "tests/simulator/test_bench.hpp"
#include "tests/support/source_tree.hpp"

namespace fogbench::simulator {
namespace {

using config::Ampere;
using config::Celsius;
using config::Degree;

class NobodyThere final : public drivers::Operator {
 public:
  Result<bool> confirm(const std::string&) override { return false; }
};

class DrivenBench : public ::testing::Test {
 protected:
  void SetUp() override {
    auto config = config::load_bench(tests::source_tree() / "config/benches/simulated.json");
    ASSERT_TRUE(config) << config.error().message;
    config_ = *std::move(config);
    config::ScenarioConfig scenario;
    scenario.noise.angle_random_walk_deg_per_sqrt_h = 0.001;
    scenario.terms = {{"bias", 0.7}, {"magnetic_linear_z", -0.25}};
    auto ends = simulate_bench(config_, scenario, 1, clock_);
    ASSERT_TRUE(ends) << ends.error().message;
    auto bench = drivers::open_bench(config_, *std::move(ends), clock_, nobody_);
    ASSERT_TRUE(bench) << bench.error().message;
    bench_ = *std::move(bench);
  }

  drivers::VirtualClock clock_;
  NobodyThere nobody_;
  config::BenchConfig config_;
  drivers::Bench bench_;
};

TEST_F(DrivenBench, HeatsToATarget) {
  ASSERT_TRUE(bench_.thermostat->set_target(Celsius{31.0}));
  ASSERT_TRUE(bench_.thermostat->set_mode(config::HeatingMode::kBoost));
  clock_.sleep_for(std::chrono::seconds(2400));
  const auto reading = bench_.thermostat->read();
  ASSERT_TRUE(reading) << reading.error().message;
  EXPECT_NEAR((reading->working_1.value + reading->working_2.value) / 2.0, 31.0, 0.05);
  EXPECT_GT(reading->normal_power.value, 1.0);
}

TEST_F(DrivenBench, DrivesTheFieldAndMeasuresItCalibrated) {
  ASSERT_TRUE(bench_.coil_vertical->enable());
  const auto before = bench_.magnetometer->read();
  ASSERT_TRUE(before) << before.error().message;
  EXPECT_NEAR(before->field[0].value, -50.0, 0.5);
  EXPECT_NEAR(before->field[1].value, 16.0, 0.5);
  ASSERT_TRUE(bench_.coil_vertical->set_current(Ampere{3.0}));
  const auto reading = bench_.magnetometer->read();
  ASSERT_TRUE(reading) << reading.error().message;
  EXPECT_NEAR(reading->field[1].value - before->field[1].value,
              3.0 * config_.simulation.magnetic.coil_ut_per_a[1], 0.1);
  ASSERT_TRUE(bench_.turntable->rotate_to(Degree{90.0}));
  const auto turned = bench_.magnetometer->read();
  ASSERT_TRUE(turned) << turned.error().message;
  EXPECT_NEAR(turned->field[2].value, reading->field[1].value, 0.5);
  ASSERT_TRUE(drivers::coils_off(bench_).reached());
}

TEST_F(DrivenBench, StreamsTheGyroWithoutALostFrame) {
  drivers::GyroBlock block;
  for (int i = 0; i < 60; ++i) {
    clock_.sleep_for(std::chrono::seconds(1));
    const Status read = bench_.gyro->read(block);
    ASSERT_TRUE(read) << read.error().message;
  }
  EXPECT_EQ(bench_.gyro->statistics().frames_missing, 0U);
  EXPECT_EQ(bench_.gyro->statistics().frames_bad_checksum, 0U);
  const double rate_hz = bench_.gyro->frame_rate_hz();
  EXPECT_NEAR(static_cast<double>(block.index.size()), 60.0 * rate_hz, 2.0);
  double mean = 0.0;
  for (const float rate : block.rate_deg_per_h) mean += static_cast<double>(rate);
  mean /= static_cast<double>(block.rate_deg_per_h.size());
  // Z points west at azimuth 0: the ambient field along it is -1 uT.
  EXPECT_NEAR(mean, 12.433 + 0.7 + 0.25 * 0.01, 5.0 * 0.001 * std::sqrt(60.0));
}

}  // namespace
}  // namespace fogbench::simulator
