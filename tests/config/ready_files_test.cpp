// Every file that comes with fogbench is read, and says what its documentation says.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "config/bench.hpp"
#include "config/device_file.hpp"
#include "config/limits.hpp"
#include "config/model_file.hpp"
#include "config/procedure.hpp"
#include "config/scenario.hpp"
#include "tests/support/source_tree.hpp"

namespace fogbench::config {
namespace {

namespace fs = std::filesystem;

const fs::path kConfig = tests::source_tree() / "config";

template <class Load>
void expect_all_are_read(const std::string& kind, Load load) {
  std::size_t count = 0;
  for (const auto& entry : fs::directory_iterator(kConfig / kind)) {
    if (entry.path().extension() != ".json") continue;
    const auto loaded = load(entry.path());
    EXPECT_TRUE(loaded) << loaded.error().message;
    ++count;
  }
  EXPECT_GT(count, 0U) << kind;
}

TEST(ReadyFiles, AreRead) {
  expect_all_are_read("devices", load_device);
  expect_all_are_read("benches", load_bench);
  expect_all_are_read("scenarios", load_scenario);
  expect_all_are_read("procedures", load_procedure);
  expect_all_are_read("models", load_model);
  expect_all_are_read("limits", load_limits);
}

TEST(ReadyFiles, SimulatedBenchHasItsInstruments) {
  const auto bench = load_bench(kConfig / "benches/simulated.json");
  ASSERT_TRUE(bench) << bench.error().message;
  EXPECT_EQ(bench->gyro.device.frame_bytes, 36);
  EXPECT_EQ(bench->gyro.device.frame_rate_hz, 100.0);
  EXPECT_THAT(bench->gyro.device.header, testing::ElementsAre(0xFE, 0x81, 0xFF, 0x55));
  EXPECT_EQ(bench->gyro.device.crc.polynomial, 0x04C11DB7U);
  EXPECT_EQ(bench->magnetometer.device.calibration_offset_ut[0], 0.022);
  EXPECT_EQ(bench->coil_vertical.device.unit, "A");
  EXPECT_TRUE(bench->turntable.device.has_value());
  EXPECT_EQ(load_bench(kConfig / "benches/simulated-1khz.json")->gyro.device.frame_rate_hz, 1000.0);
}

TEST(ReadyFiles, HiddenEffectKeepsItsInnerParameters) {
  const auto scenario = load_scenario(kConfig / "scenarios/hysteresis-z.json");
  ASSERT_TRUE(scenario) << scenario.error().message;
  ASSERT_EQ(scenario->hidden.size(), 1U);
  EXPECT_EQ(scenario->hidden[0].effect, "magnetic_hysteresis_z");
  EXPECT_EQ(scenario->hidden[0].amplitude, 0.12);
  EXPECT_EQ(scenario->hidden[0].parameters.at("width"), 0.6);
  EXPECT_EQ(scenario->noise.angle_random_walk_deg_per_sqrt_h, 0.001);
}

}  // namespace
}  // namespace fogbench::config
