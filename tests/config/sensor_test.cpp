// Descriptions of auxiliary sensors whose parts do not agree are refused on reading, and so is a
// bench on which two of them would be taken for one.

#include "config/sensor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/bench.hpp"
#include "config/device_file.hpp"
#include "tests/config/changed_file.hpp"

namespace fogbench::config {
namespace {

using testing::HasSubstr;

struct SensorMistake {
  const char* file;
  const char* patch;
  const char* message;  ///< part of it
};

class SensorMistakes : public testing::TestWithParam<SensorMistake> {};

TEST_P(SensorMistakes, AreNamed) {
  ChangedFile file;
  EXPECT_THAT(message_of(load_device(file.patch(GetParam().file, GetParam().patch))),
              HasSubstr(GetParam().message));
}

constexpr const char* kBarometer = "devices/barometer-modbus.json";
constexpr const char* kVoltmeter = "devices/voltmeter-scpi.json";
constexpr const char* kHygrometer = "devices/hygrometer-lines.json";
constexpr const char* kLightMeter = "devices/light-meter-hid.json";

INSTANTIATE_TEST_SUITE_P(
    OfEveryKind, SensorMistakes,
    testing::Values(
        SensorMistake{
            kBarometer,
            R"([{"op": "replace", "path": "/channels/0/name", "value": "temperature_c"}])",
            "/channels/0/name: found \"temperature_c\", expected a name that no column of the "
            "record has already"},
        SensorMistake{kBarometer,
                      R"([{"op": "replace", "path": "/channels/0/name", "value": "segment"}])",
                      "expected a name that no column"},
        SensorMistake{kBarometer,
                      R"([{"op": "replace", "path": "/channels/0/name", "value": "p\"; DROP"}])",
                      "/channels/0/name"},
        SensorMistake{kBarometer,
                      R"([{"op": "replace", "path": "/channels/1/name", "value": "pressure_hpa"}])",
                      "/channels/1/name: found \"pressure_hpa\", expected a name that does not "
                      "stand twice"},
        SensorMistake{kBarometer,
                      R"([{"op": "replace", "path": "/channels/0/type", "value": "uint8"}])",
                      "/channels/0/type: found \"uint8\", expected a type of 16 or 32 bits"},
        SensorMistake{kBarometer, R"([{"op": "replace", "path": "/channels/0/scale", "value": 0}])",
                      "/channels/0/scale: found 0, expected a number other than 0"},
        SensorMistake{kBarometer,
                      R"([{"op": "replace", "path": "/channels/0/minimum", "value": 2000}])",
                      "/channels/0/minimum: found 2000, expected at most the maximum 1200"},
        SensorMistake{kBarometer, R"([{"op": "replace", "path": "/channels", "value": []}])",
                      "/channels"},
        SensorMistake{kVoltmeter,
                      R"([{"op": "replace", "path": "/channels/0/query", "value": "VOLT 5"}])",
                      "/channels/0/query: found \"VOLT 5\", expected a question"},
        SensorMistake{kHygrometer, R"([{"op": "remove", "path": "/channels/0/position"}])",
                      "position"},
        SensorMistake{kLightMeter,
                      R"([{"op": "replace", "path": "/channels/0/offset_bytes", "value": 5}])",
                      "/channels/0/offset_bytes: found 5, expected the number to lie inside the "
                      "report of 8 bytes"},
        SensorMistake{kLightMeter,
                      R"([{"op": "replace", "path": "/channels/0/offset_bytes", "value": 0}])",
                      "/channels/0/offset_bytes: found 0"}));

class MistakesOfABench : public testing::TestWithParam<SensorMistake> {};

TEST_P(MistakesOfABench, OfItsSensorsAreNamed) {
  ChangedFile file;
  EXPECT_THAT(message_of(load_bench(file.patch(GetParam().file, GetParam().patch))),
              HasSubstr(GetParam().message));
}

constexpr const char* kBench = "benches/simulated-auxiliary.json";

INSTANTIATE_TEST_SUITE_P(
    WithSensors, MistakesOfABench,
    testing::Values(
        SensorMistake{
            kBench, R"([{"op": "replace", "path": "/auxiliary/0/name", "value": "gyro"}])",
            "/auxiliary/0/name: found \"gyro\", expected a name that no other instrument"},
        SensorMistake{kBench,
                      R"([{"op": "copy", "from": "/auxiliary/0", "path": "/auxiliary/1"},
                          {"op": "replace", "path": "/auxiliary/1/name", "value": "second"}])",
                      "has a channel pressure_hpa, as a sensor before it has"},
        SensorMistake{kBench,
                      R"([{"op": "replace", "path": "/auxiliary/0/device",
                           "value": "../devices/coil-kepco.json"}])",
                      "names no sensor"},
        SensorMistake{kBench,
                      R"([{"op": "replace", "path": "/auxiliary/0/connection",
                           "value": "usb:0x0001:0x0002:X"}])",
                      "expected a Modbus sensor on tcp: or rtu:"},
        SensorMistake{
            kBench,
            R"([{"op": "replace", "path": "/interlocks/0/all_of/0/channel",
                           "value": "supply_a"}])",
            "/interlocks/0: watches the channel \"supply_a\", which nothing on this bench "
            "measures"},
        SensorMistake{kBench,
                      R"([{"op": "replace", "path": "/interlocks/0/all_of/0/clear", "value": 4}])",
                      "/interlocks/0/all_of/0/clear: found 4, expected at least trip 4.5"}));

TEST(Sensors, AnswerForTheirChannelsInTheOrderOfTheBench) {
  const auto bench = load_bench(kReady / kBench);
  ASSERT_TRUE(bench) << bench.error().message;
  std::vector<std::string> names;
  for (const SensorChannel& channel : auxiliary_channels(*bench)) names.push_back(channel.name);
  EXPECT_THAT(names, testing::ElementsAre("pressure_hpa", "room_c", "supply_v", "humidity_percent",
                                          "illuminance_lx"));
}

}  // namespace
}  // namespace fogbench::config
