#include "config/bench.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/config/changed_file.hpp"

namespace fogbench::config {
namespace {

using testing::HasSubstr;

struct BenchMistake {
  const char* patch;
  const char* message;
};

class BenchMistakes : public testing::TestWithParam<BenchMistake> {};

TEST_P(BenchMistakes, AreNamed) {
  ChangedFile file;
  const auto bench = load_bench(file.patch("benches/simulated.json", GetParam().patch));
  EXPECT_THAT(message_of(bench), HasSubstr(GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(
    All, BenchMistakes,
    testing::Values(
        BenchMistake{
            R"([{"op": "replace", "path": "/gyro/device", "value": "../devices/none.json"}])",
            "changed.json: /gyro/device: \"../devices/none.json\", seen from this file, is "},
        BenchMistake{R"([{"op": "replace", "path": "/gyro/device", "value": "gyro-kwh"}])",
                     "expected a path from there, or a ready device (barometer-modbus, "},
        BenchMistake{R"([{"op": "replace", "path": "/gyro/device", "value": "../gyro-kvh.json"}])",
                     ": no such file; expected a path from there, or the ready device's name, "
                     "\"gyro-kvh\""},
        BenchMistake{R"([{"op": "add", "path": "/magnetometer/fitted", "value": false}])",
                     "/magnetometer/device: found \"magnetometer-hid\", expected none"},
        BenchMistake{R"([{"op": "remove", "path": "/magnetometer/device"}])",
                     "/magnetometer/device: found nothing, expected a device file"},
        BenchMistake{R"([{"op": "add", "path": "/magnetometer/ambient_ut", "value": [0, 0, 0]}])",
                     "/magnetometer/ambient_ut: found a list of 3, expected none"},
        BenchMistake{
            R"([{"op": "replace", "path": "/gyro/device", "value": "../devices/coil-kepco.json"}])",
            "/gyro/device: names a device of the wrong kind for this instrument"},
        BenchMistake{R"([{"op": "replace", "path": "/gyro/connection", "value": "ttyUSB0"}])",
                     "/gyro/connection: found \"ttyUSB0\", expected \"simulated\", or an address"},
        BenchMistake{R"([{"op": "replace", "path": "/gyro/connection", "value": "tty:"}])",
                     "/gyro/connection: found \"tty:\", expected tty:TTY"},
        BenchMistake{
            R"([{"op": "replace", "path": "/gyro/connection", "value": "tcp:127.0.0.1:502"}])",
            "/gyro/connection: found \"tcp:127.0.0.1:502\", expected a gyro on tty:"},
        BenchMistake{
            R"([{"op": "replace", "path": "/thermostat/connection", "value": "tty:/dev/tty1"}])",
            "/thermostat/connection: found \"tty:/dev/tty1\", expected a thermostat on tcp: or"},
        BenchMistake{
            R"([{"op": "replace", "path": "/magnetometer/connection",
                     "value": "usb:0x1209:0x0001:M"}])",
            "/magnetometer/connection: found \"usb:0x1209:0x0001:M\", expected a magnetometer"},
        BenchMistake{R"([{"op": "replace", "path": "/coil_vertical/connection",
                     "value": "hid:0x1209:0x0001:M"}])",
                     "expected a coil supply on usb: or tty:"},
        BenchMistake{R"([{"op": "replace", "path": "/turntable/connection",
                     "value": "hid:0x1209:0x0001:M"}])",
                     "expected a turntable on usb: or tty:"},
        BenchMistake{
            R"([{"op": "replace", "path": "/thermostat/calibrated_on", "value": "2026-02-30"}])",
            "/thermostat/calibrated_on: found \"2026-02-30\", expected a date, YYYY-MM-DD"},
        BenchMistake{
            R"([{"op": "replace", "path": "/thermostat/calibration_due", "value": "soon"}])",
            "/thermostat/calibration_due: found \"soon\""},
        BenchMistake{
            R"([{"op": "replace", "path": "/coil_vertical/current_limit_a", "value": 6.5}])",
            "/coil_vertical/current_limit_a: found 6.5, expected at most 6 A"},
        BenchMistake{R"([{"op": "replace", "path": "/coil_vertical/device",
                     "value": "../devices/turntable-scpi.json"}])",
                     "/coil_vertical/device: sets deg; expected a supply that sets A"},
        BenchMistake{R"([{"op": "replace", "path": "/turntable/device",
                     "value": "../devices/coil-kepco.json"}])",
                     "/turntable/device: sets A; expected a turntable that sets deg"},
        BenchMistake{R"([{"op": "replace", "path": "/turntable/motorised", "value": false}])",
                     "/turntable/device: found \"turntable-scpi\", expected none"},
        BenchMistake{R"([{"op": "remove", "path": "/turntable/device"}])",
                     "/turntable/device: found nothing, expected a device file"},
        BenchMistake{R"([{"op": "replace", "path": "/gyro/frame_rate_hz", "value": 2600}])",
                     "/gyro/frame_rate_hz: found 2600, expected at most 2560.0"},
        BenchMistake{R"([{"op": "replace", "path": "/gyro/max_gap_s", "value": 0.001}])",
                     "/gyro/max_gap_s: found 0.001, expected at least one frame, 0.01 s"},
        BenchMistake{R"([{"op": "replace", "path": "/limits/temperature_minimum_c", "value": 60}])",
                     "/limits/temperature_minimum_c: found 60, expected less than"},
        BenchMistake{R"([{"op": "replace", "path": "/limits/temperature_maximum_c", "value": 71}])",
                     "expected at most the thermostat's target_maximum_c 70"},
        BenchMistake{R"([{"op": "replace", "path": "/interlocks", "value": []}])",
                     "/interlocks: found an empty list, expected a list that is not empty"},
        BenchMistake{
            R"([{"op": "replace", "path": "/interlocks/0/all_of", "value": []}])",
            "/interlocks/0/all_of: found an empty list, expected a list that is not empty"},
        BenchMistake{
            R"([{"op": "remove", "path": "/interlocks/1/all_of"}])",
            "/interlocks/1: expected either \"all_of\" or \"any_of\", with its conditions"},
        BenchMistake{
            R"([{"op": "replace", "path": "/interlocks/3/all_of/0/kind", "value": "field"}])",
            "/interlocks/3/all_of/0/kind: found \"field\", expected one of \"over_temperature\""},
        BenchMistake{
            R"([{"op": "replace", "path": "/interlocks/3/all_of/0/clear_ut", "value": 16}])",
            "/interlocks/3/all_of/0/clear_ut: found 16, expected at most trip_ut 15"},
        BenchMistake{R"([{"op": "move", "from": "/interlocks/3/all_of/0/trip_ut",
                     "path": "/interlocks/3/all_of/0/trip_t"}])",
                     "/interlocks/3/all_of/0/trip_t: unknown key; did you mean \"trip_ut\"?"},
        BenchMistake{R"([{"op": "add", "path": "/interlocks/3/all_of/0/rise_c", "value": 1}])",
                     "/interlocks/3/all_of/0/rise_c: unknown key"},
        BenchMistake{R"([{"op": "replace", "path": "/interlocks/3/action", "value": "stop"}])",
                     "/interlocks/3/action: found \"stop\", expected one of \"warn\", \"pause\""},
        BenchMistake{R"([{"op": "replace", "path": "/interlocks/3/consecutive", "value": 0}])",
                     "/interlocks/3/consecutive: found 0, expected an integer"},
        BenchMistake{R"([{"op": "replace", "path": "/interlocks/3/name", "value": "sensors"}])",
                     "/interlocks/3/name: found \"sensors\", expected another name than that of"},
        BenchMistake{
            R"([{"op": "replace", "path": "/interlocks/0/action", "value": "warn"}])",
            "/interlocks: no over_temperature by itself aborts above temperature_maximum_c 60"},
        BenchMistake{
            R"([{"op": "replace", "path": "/interlocks/0/all_of/0/trip_c", "value": 62.5}])",
            "/interlocks: no over_temperature by itself"},
        BenchMistake{R"([{"op": "replace", "path": "/interlocks/0/consecutive", "value": 11}])",
                     "expected one with trip_c 62 and consecutive 10 at most"},
        BenchMistake{
            R"([{"op": "add", "path": "/simulation/thermal/dead_time_s", "value": 1e300}])",
            "/simulation/thermal/dead_time_s: found 1e+300, expected a number from 0 to 3600"},
        BenchMistake{
            R"([{"op": "add", "path": "/simulation/magnetic/ambient_steps_per_h",
                     "value": 1e300}])",
            "/simulation/magnetic/ambient_steps_per_h: found 1e+300, expected a number from 0"},
        BenchMistake{R"([{"op": "add", "path": "/simulation/step_s", "value": 2}])",
                     "/simulation/step_s: found 2, expected a number from 0.001 to 1"},
        BenchMistake{R"([{"op": "replace", "path": "/simulation/magnetic/sensor_matrix",
                     "value": [[1, 0, 0], [1, 0, 0], [0, 0, 1]]}])",
                     "/simulation/magnetic/sensor_matrix: cannot be inverted"}));

TEST(LoadBench, ACopyAnywhereNamesReadyDevices) {
  const support::TemporaryFolder folder;
  const auto copy = folder.path() / "mine.json";
  std::filesystem::copy_file(kReady / "benches/simulated-auxiliary.json", copy);
  const auto bench = load_bench(copy);
  ASSERT_TRUE(bench) << bench.error().message;
  EXPECT_EQ(bench->gyro.device.frame_bytes, 36);
  // A file of its own beside it is taken by its path, however its name looks.
  std::filesystem::copy_file(kReady / "devices/gyro-crc8.json", folder.path() / "gyro-kvh");
  EXPECT_EQ(*device_file(copy, "gyro-kvh"), folder.path() / "gyro-kvh");
  EXPECT_EQ(device_file(copy, "coil-kepco")->filename(), "coil-kepco.json");
}

TEST(LoadBench, AUnitThatNobodyHasOnASerialLineIsRefusedThereOnly) {
  support::TemporaryFolder folder;
  auto device = *read_json_file(kReady / "devices/thermostat-eurotherm.json");
  device["unit_id"] = 255;
  const auto path = folder.file("anybody.json", device.dump()).string();
  const auto connected = [&](const std::string& connection) {
    ChangedFile file;
    return load_bench(
        file.patch("benches/simulated.json",
                   R"([{"op": "replace", "path": "/thermostat/device", "value": ")" + path +
                       R"("}, {"op": "replace", "path": "/thermostat/connection", "value": ")" +
                       connection + R"("}])"));
  };
  EXPECT_TRUE(connected("tcp:10.0.0.1:502"));
  EXPECT_THAT(message_of(connected("rtu:/dev/ttyUSB0:9600")),
              HasSubstr("/thermostat/device: unit_id is 255; expected 1 to 247 on a serial line"));
}

TEST(LoadBench, NameOfADeviceThatNoFileCanHaveIsNamed) {
  ChangedFile file;
  const std::string name(5000, 'x');  // longer than the system's longest
  const auto bench = load_bench(
      file.patch("benches/simulated.json",
                 R"([{"op": "replace", "path": "/gyro/device", "value": ")" + name + R"("}])"));
  EXPECT_THAT(message_of(bench), HasSubstr("/gyro/device: "));
}

TEST(LoadBench, ErrorInADeviceFileNamesThatFile) {
  support::TemporaryFolder folder;
  const auto device = folder.file("gyro.json", R"({"kind": "frame", "nmae": "x"})");
  ChangedFile file;
  const auto bench = load_bench(file.patch(
      "benches/simulated.json",
      R"([{"op": "replace", "path": "/gyro/device", "value": ")" + device.string() + R"("}])"));
  EXPECT_EQ(message_of(bench), device.string() + ": /nmae: unknown key; did you mean \"name\"?");
}

TEST(LoadBench, CertificateOfTheBenchReplacesTheDeviceFilesCalibration) {
  ChangedFile file;
  const auto without = load_bench(file.patch(
      "benches/simulated.json", R"([{"op": "remove", "path": "/magnetometer/calibration"}])"));
  ASSERT_TRUE(without) << without.error().message;
  EXPECT_EQ(without->magnetometer.device.calibration_offset_ut[0], 0.0);
  EXPECT_EQ(
      load_bench(kReady / "benches/simulated.json")->magnetometer.device.calibration_offset_ut[0],
      0.022);
}

TEST(LoadBench, WithoutInterlocksHasOneOfEachKindForItsOwnLimits) {
  ChangedFile file;
  const auto bench =
      load_bench(file.patch("benches/simulated.json", R"([{"op": "remove", "path": "/interlocks"},
        {"op": "replace", "path": "/limits/temperature_maximum_c", "value": 50}])"));
  ASSERT_TRUE(bench) << bench.error().message;
  std::vector<InterlockKind> expected;
  for (const InterlockKindInfo& info : interlock_kinds()) {
    if (!watches_channel(info.kind)) expected.push_back(info.kind);
  }
  std::vector<InterlockKind> kinds;
  for (const InterlockConfig& interlock : bench->interlocks) {
    kinds.push_back(interlock.all_of.at(0).kind);
  }
  EXPECT_EQ(kinds, expected);
  EXPECT_EQ(bench->interlocks[0].all_of[0].trip, 52.0);
  EXPECT_EQ(bench->interlocks[0].action, InterlockAction::kAbort);
}

TEST(LoadBench, ReadsAnInterlockOfSeveralConditions) {
  ChangedFile file;
  const auto bench = load_bench(
      file.patch("benches/simulated.json", R"([{"op": "add", "path": "/interlocks/-", "value":
        {"name": "either", "consecutive": 7, "action": "pause", "any_of": [
          {"kind": "heater_without_effect", "trip_s": 600, "clear_s": 0, "rise_c": 0.3},
          {"kind": "calibration_overdue", "trip_days": -7, "clear_days": -30}]}}])"));
  ASSERT_TRUE(bench) << bench.error().message;
  const InterlockConfig& either = bench->interlocks.back();
  EXPECT_EQ(either.consecutive, 7);
  ASSERT_EQ(either.conditions().size(), 2U);
  EXPECT_EQ(either.any_of[0].rise, Celsius{0.3});
  EXPECT_EQ(either.any_of[0].near_target, Celsius{2.0});
  EXPECT_EQ(either.any_of[1].trip, -7.0);
}

/// The certificate takes the simulated magnetometer's errors of tenths of a percent down to 0.01 %
/// and a few nT, and no further: a calibration has an uncertainty of its own.
TEST(LoadBench, CertificateOfTheSimulatedMagnetometerLeavesASmallResidual) {
  for (const char* name : {"benches/simulated.json", "benches/simulated-1khz.json"}) {
    const auto bench = load_bench(kReady / name);
    ASSERT_TRUE(bench) << bench.error().message;
    const auto& device = bench->magnetometer.device;
    const MagneticPlant& plant = bench->simulation.magnetic;
    double largest = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        double product = i == j ? -1.0 : 0.0;
        for (std::size_t k = 0; k < 3; ++k) {
          product += device.calibration_matrix[i][k] * plant.sensor_matrix[k][j];
        }
        largest = std::max(largest, std::abs(product));
      }
      const double offset = std::abs(plant.sensor_offset_ut[i] - device.calibration_offset_ut[i]);
      EXPECT_GT(offset, 0.0005);
      EXPECT_LT(offset, 0.005);
    }
    EXPECT_GT(largest, 0.5e-4);
    EXPECT_LT(largest, 1.5e-4);
  }
}

}  // namespace
}  // namespace fogbench::config
