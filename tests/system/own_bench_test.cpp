// A bench of one's own, as README says: a copy of a ready bench file, device files of one's own
// beside it, and the ready acceptance. A unit test cannot tell whether these steps are enough.

#include <gmock/gmock.h>

#include <fstream>

#include "tests/system/fogbench.hpp"

namespace fogbench::system_tests {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// Of the thermostat: other registers, 16 bits where the ready ones have floats.
constexpr auto kThermostat = R"({
  "kind": "modbus", "name": "our controller",
  "registers": [
    {"name": "temperature_working_1", "address": 100, "type": "int16", "scale": 0.002, "unit": "degC"},
    {"name": "temperature_working_2", "address": 101, "type": "int16", "scale": 0.002, "unit": "degC"},
    {"name": "temperature_control", "address": 102, "type": "int16", "scale": 0.002, "unit": "degC"},
    {"name": "temperature_ambient", "address": 103, "type": "int16", "scale": 0.002, "unit": "degC"},
    {"name": "target", "address": 200, "type": "int16", "scale": 0.1, "access": "read_write"},
    {"name": "mode", "address": 201, "type": "uint16", "access": "read_write"},
    {"name": "boost_power", "address": 300, "type": "uint16", "scale": 1, "unit": "mW"},
    {"name": "normal_power", "address": 301, "type": "uint16", "scale": 1, "unit": "mW"}],
  "modes": {"off": 0, "boost": 1, "normal": 2},
  "target_minimum_c": 0, "target_maximum_c": 70})";

/// Of the gyro: no status, a counter of 16 bits, the rate in rad/s.
constexpr auto kGyro = R"({
  "kind": "frame", "name": "our gyro", "header": "AA 55", "frame_bytes": 14,
  "rate": {"name": "rate", "offset_bytes": 4, "type": "float32", "unit": "rad/s"},
  "temperature": {"name": "temperature", "offset_bytes": 8, "type": "int16", "scale": 0.01},
  "sequence_offset_bytes": 2, "sequence_type": "uint16", "sequence_modulus": 65536,
  "crc": {"width_bits": 32, "polynomial": "0x04C11DB7", "initial": "0xFFFFFFFF",
          "count_bytes": 10, "offset_bytes": 10},
  "frame_rate_hz": 100, "baud": 115200, "stuck_after_s": 0.05})";

class OwnBenchTest : public FogbenchTest {
 protected:
  /// A copy of the ready bench: 200 uT, no motor, our devices; `change` does what a case is about.
  std::string bench(const std::function<void(nlohmann::json&)>& change = {}) const {
    folder_.file("our-thermostat.json", kThermostat);
    folder_.file("our-gyro.json", kGyro);
    std::ifstream ready(tests::source_tree() / "config/benches/simulated.json");
    auto bench = nlohmann::json::parse(ready);
    bench["name"] = "ours";
    bench["limits"]["field_maximum_ut"] = 200;
    bench["turntable"] = {{"motorised", false}};
    bench["thermostat"]["device"] = "our-thermostat.json";
    bench["gyro"]["device"] = "our-gyro.json";
    bench["gyro"].erase("frame_rate_hz");
    if (change) change(bench);
    return folder_.file("bench.json", bench.dump()).string();
  }
};

const std::string kLevels = "levels_ut=0,100,200,100,0,-100,-200,-100,0";

TEST_F(OwnBenchTest, OtherLevelsRegistersAndFramesNeedNoCopyOfAProcedure) {
  const std::string file = bench();
  const Finished thermostat =
      fogbench({"device", "check", (folder_ / "our-thermostat.json").string()});
  EXPECT_EQ(thermostat.status, 0) << thermostat.err;
  EXPECT_THAT(thermostat.out, HasSubstr("our controller, modbus: unit 1; set points from 0 to 70"));
  const Finished gyro = fogbench({"device", "check", (folder_ / "our-gyro.json").string()});
  EXPECT_EQ(gyro.status, 0) << gyro.err;
  EXPECT_THAT(gyro.out, HasSubstr("sequence 0 ... 65535, uint16 in byte 2, no status"));

  const std::vector<std::string> quick{"--bench", file,          "--set",  "average_s=3",
                                       "--set",   "warm_up_s=0", "--seed", "1"};
  expect_refused(support::run(dry_run({"acceptance"}, quick)), 3, "200 uT");
  auto ours = quick;
  ours.insert(ours.end(), {"--set", kLevels});
  const Finished planned = fogbench({"plan", "acceptance", "--bench", file, "--set", kLevels});
  EXPECT_EQ(planned.status, 0) << planned.err;
  EXPECT_THAT(planned.out, HasSubstr("field: levels -200 to 200 uT, allowed up to 200 uT"));
  const Finished done = support::run(dry_run({"acceptance"}, ours));
  ASSERT_EQ(done.status, 0) << done.err;

  const auto run = json({"show", "1", "--store", store(), "--json"});
  EXPECT_EQ(run["outcome"], "completed");
  std::string events;
  for (const auto& event : run["events"]) events += event["message"].get<std::string>() + "\n";
  EXPECT_THAT(events, HasSubstr("asks: Turn the gyro from azimuth 0 deg to 90 deg, then confirm."));
  EXPECT_THAT(events, HasSubstr("answer yes to \"Turn the gyro from azimuth 0 deg to 90 deg, then "
                                "confirm.\", by the simulation"));
  for (const auto& point : run["measured"]) {
    if (point["segment"] != "coil_z/up" || point["field_set_ut"] != 200.0) continue;
    EXPECT_NEAR(point["field_z_ut"].get<double>(), 200.0, 3.0) << "the gyro has been turned";
    EXPECT_NEAR(point["field_y_ut"].get<double>(), 0.0, 5.0);
    EXPECT_LT(std::abs(point["rate_deg_per_h"].get<double>()), 5.0) << "rad/s are taken to deg/h";
  }
  EXPECT_EQ(fogbench({"verdict", "1", "--store", store()}).err, "");
}

TEST_F(OwnBenchTest, WithoutAFluxgateTheFieldIsReckonedAndTheRecordSaysSo) {
  const std::string file = bench([](auto& bench) {
    bench["magnetometer"] = {{"fitted", false}, {"ambient_ut", {-50.0, 16.0, 1.0}}};
  });
  const Finished done = support::run(dry_run(
      {"coil-sweep"}, {"--bench", file, "--set", "average_s=3", "--set", kLevels, "--seed", "1"}));
  ASSERT_EQ(done.status, 0) << done.err;
  const auto run = json({"show", "1", "--store", store(), "--json"});
  bool says = false;
  for (const auto& instrument : run["instruments"]) {
    says = says || instrument["identity"] == "none: the field is reckoned from the coils' currents";
  }
  EXPECT_TRUE(says) << run["instruments"];
  for (const auto& point : run["measured"]) {
    if (point["segment"] != "coil_x/up" || point["field_set_ut"] != 200.0) continue;
    EXPECT_NEAR(point["field_x_ut"].get<double>(), 200.0, 1.0);
  }
}

TEST_F(OwnBenchTest, AMistakeSaysWhatWasExpected) {
  const std::string file =
      bench([](auto& bench) { bench["gyro"]["device"] = "devices/gyro-kvh.json"; });
  expect_refused(fogbench({"plan", "static-record", "--bench", file}), 3,
                 "/gyro/device: \"devices/gyro-kvh.json\", seen from this file, is " +
                     (folder_ / "devices/gyro-kvh.json").string() +
                     ": no such file; expected a path from there, or the ready device's name, "
                     "\"gyro-kvh\"");
}

}  // namespace
}  // namespace fogbench::system_tests
