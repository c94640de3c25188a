// `fogbench device` as its user meets it.

#include <gmock/gmock.h>

#include <fstream>

#include "tests/system/fogbench.hpp"

namespace fogbench::system_tests {
namespace {

using ::testing::HasSubstr;

class DeviceCommand : public FogbenchTest {
 protected:
  std::string written(const std::string& text) const {
    const auto file = folder_ / "device.json";
    std::ofstream(file) << text;
    return file.string();
  }
};

TEST_F(DeviceCommand, SaysWhatEveryReadyDescriptionSays) {
  const std::pair<const char*, const char*> ready[] = {
      {"thermostat-eurotherm", "temperature_working_1"},
      {"thermostat-omron", "even register counts only"},
      {"thermostat-watlow", "low word first"},
      {"coil-kepco", "MEAS:CURR?"},
      {"turntable-scpi", "from -360 to 360 deg"},
      {"magnetometer-hid", "fields within +-600 uT"},
      {"gyro-kvh", "FE 81 FF 55"},
      {"gyro-crc8", "8 bits of check in byte 11"}};
  for (const auto& [name, says] : ready) {
    const Finished done = fogbench({"device", "check", name});
    EXPECT_EQ(done.status, 0) << done.err;
    EXPECT_THAT(done.out, HasSubstr(says));
    EXPECT_EQ(done.err, "");
    EXPECT_FALSE(json({"device", "check", name, "--json"})["kind"].is_null()) << name;
  }
}

TEST_F(DeviceCommand, NamesEachProblemInALineOfItsOwn) {
  const Finished done = fogbench(
      {"device", "check", written(R"({"kind": "scpi", "name": "x", "identity": "y", "set": "CURR",
        "set_query": "CURR?", "measure_query": "MEAS?", "unit": "A", "minimum": "-1",
        "maximum": 1, "resolution": 0, "tolerance": 0.1})")});
  EXPECT_EQ(done.status, 3);
  EXPECT_EQ(done.out, "");
  EXPECT_EQ(std::count(done.err.begin(), done.err.end(), '\n'), 4) << done.err;
  for (const char* says : {"/minimum: found \"-1\", expected a number", "/resolution: found 0",
                           "/tolerance: unknown key", "has no key \"read_back_tolerance\""}) {
    EXPECT_THAT(done.err, HasSubstr(says));
  }
}

TEST_F(DeviceCommand, WithoutASubcommandOrAFileIsAUsageError) {
  expect_refused(fogbench({"device"}), 2, "subcommand");
  expect_refused(fogbench({"device", "check"}), 2, "DEVICE");
  expect_refused(fogbench({"device", "check", "no-such-device"}), 3, "no-such-device");
  expect_refused(fogbench({"device", "probe", "gyro-kvh"}), 2, "--bench");
  expect_refused(fogbench({"device", "probe", "gyro-kvh", "--bench", "factory"}), 3,
                 "it has coil_horizontal");
  expect_refused(fogbench({"device", "probe", "gyro", "--bench", "simulated"}), 3, "simulated");
}

}  // namespace
}  // namespace fogbench::system_tests
