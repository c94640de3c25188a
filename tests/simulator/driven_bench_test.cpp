// The real drivers on the far ends, with the ready bench's own files.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "config/bench.hpp"
#include "config/device_file.hpp"
#include "drivers/open_bench.hpp"
#include "drivers/safe_state.hpp"
#include "tests/simulator/test_bench.hpp"
#include "tests/support/source_tree.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/wire_tap.hpp"

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

/// The ready device file with another unit and what goes with it.
template <class Device>
Device in_other_units(const char* name, const char* patch) {
  const support::TemporaryFolder folder;
  const auto text =
      nlohmann::json::parse(support::read_text(tests::source_tree() / "config/devices" / name));
  const auto device = config::load_device(
      folder.file("device.json", text.patch(nlohmann::json::parse(patch)).dump()));
  EXPECT_TRUE(device) << device.error().message;
  return device ? std::get<Device>(*device) : Device{};
}

TEST_F(DrivenBench, ReadsTheSameFromInstrumentsThatSpeakInOtherUnits) {
  config_.gyro.device = in_other_units<config::FrameDevice>(
      "gyro-kvh.json", R"([{"op": "replace", "path": "/rate/unit", "value": "rad/s"}])");
  config_.magnetometer.device = in_other_units<config::HidDevice>("magnetometer-hid.json", R"([
    {"op": "replace", "path": "/fields/0/unit", "value": "nT"},
    {"op": "replace", "path": "/fields/0/scale", "value": 0.1},
    {"op": "replace", "path": "/fields/1/unit", "value": "G"},
    {"op": "replace", "path": "/fields/1/scale", "value": 1e-6}])");
  config_.thermostat.device = in_other_units<config::ModbusDevice>("thermostat-eurotherm.json", R"([
    {"op": "replace", "path": "/registers/0/unit", "value": "degF"},
    {"op": "replace", "path": "/registers/0/minimum", "value": 41},
    {"op": "replace", "path": "/registers/0/maximum", "value": 248},
    {"op": "replace", "path": "/registers/4/unit", "value": "K"},
    {"op": "replace", "path": "/registers/4/minimum", "value": 273.15},
    {"op": "replace", "path": "/registers/4/maximum", "value": 343.15},
    {"op": "add", "path": "/registers/4/offset", "value": 0.05}])");
  config_.coil_vertical.device = in_other_units<config::ScpiDevice>("coil-kepco.json", R"([
    {"op": "replace", "path": "/unit", "value": "mA"},
    {"op": "replace", "path": "/minimum", "value": -6000},
    {"op": "replace", "path": "/maximum", "value": 6000},
    {"op": "replace", "path": "/resolution", "value": 0.183},
    {"op": "replace", "path": "/read_back_tolerance", "value": 5}])");
  drivers::VirtualClock clock;
  auto ends = simulate_bench(config_, {}, 1, clock);
  ASSERT_TRUE(ends) << ends.error().message;
  support::WireTrace trace;
  auto opened =
      drivers::open_bench(config_, support::tapped(*std::move(ends), trace), clock, nobody_);
  ASSERT_TRUE(opened) << opened.error().message;

  ASSERT_TRUE(opened->thermostat->set_target(Celsius{31.0}));
  const auto thermostat = opened->thermostat->read();
  ASSERT_TRUE(thermostat) << thermostat.error().message;
  EXPECT_NEAR(thermostat->working_1.value, 21.0, 0.1);
  EXPECT_NEAR(thermostat->target.value, 31.0, 1e-9);
  EXPECT_FALSE(opened->thermostat->set_target(Celsius{70.5})) << "343.65 K are too many";

  ASSERT_TRUE(opened->coil_vertical->enable());
  ASSERT_TRUE(opened->coil_vertical->set_current(Ampere{3.0}));
  const auto coil = opened->coil_vertical->read();
  ASSERT_TRUE(coil) << coil.error().message;
  EXPECT_NEAR(coil->set.value, 3.0, 2e-4);
  EXPECT_NEAR(coil->measured.value, 3.0, 1e-3);
  EXPECT_NE(trace.text().find("CURR 2999.9"), std::string::npos) << "in mA on the wire";

  const auto field = opened->magnetometer->read();
  ASSERT_TRUE(field) << field.error().message;
  // Without its certificate, and beside a pair of coils that is not quite level.
  EXPECT_NEAR(field->field[0].value, -50.0, 2.5);
  EXPECT_NEAR(field->field[1].value, 16.0 + 3.0 * config_.simulation.magnetic.coil_ut_per_a[1],
              2.5);

  drivers::GyroBlock block;
  clock.sleep_for(std::chrono::seconds(1));
  ASSERT_TRUE(opened->gyro->read(block));
  ASSERT_FALSE(block.rate_deg_per_h.empty());
  EXPECT_NEAR(block.rate_deg_per_h.back(), 12.433F, 1e-3F);
}

}  // namespace
}  // namespace fogbench::simulator
