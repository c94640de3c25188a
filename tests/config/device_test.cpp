// Descriptions of instruments whose parts do not agree with each other are refused on reading, not
// on the bench.

#include "config/device.hpp"
#include "config/device_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/config/changed_file.hpp"
#include "tests/support/source_tree.hpp"

namespace fogbench::config {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

struct Mistake {
  const char* file;
  const char* patch;
  const char* message;  ///< part of it
};

class DeviceMistakes : public testing::TestWithParam<Mistake> {};

TEST_P(DeviceMistakes, AreNamed) {
  ChangedFile file;
  const auto device = load_device(file.patch(GetParam().file, GetParam().patch));
  EXPECT_THAT(message_of(device), HasSubstr(GetParam().message));
}

constexpr const char* kEurotherm = "devices/thermostat-eurotherm.json";
constexpr const char* kOmron = "devices/thermostat-omron.json";
constexpr const char* kCoil = "devices/coil-kepco.json";
constexpr const char* kHid = "devices/magnetometer-hid.json";
constexpr const char* kKvh = "devices/gyro-kvh.json";

INSTANTIATE_TEST_SUITE_P(
    Modbus, DeviceMistakes,
    testing::Values(
        Mistake{
            kEurotherm, R"([{"op": "replace", "path": "/kind", "value": "modbuss"}])",
            "/kind: found \"modbuss\", expected one of modbus, scpi, hid, frame, modbus_sensor"},
        Mistake{kEurotherm, R"([{"op": "remove", "path": "/kind"}])", "/kind: found nothing"},
        Mistake{kEurotherm, R"([{"op": "remove", "path": "/registers/0"}])",
                "/registers: has no \"temperature_working_1\""},
        Mistake{kEurotherm,
                R"([{"op": "add", "path": "/registers/-", "value": {"name": "target",
                     "address": 900}}])",
                "/registers/10/name: found \"target\", expected a name that does not stand twice"},
        Mistake{kEurotherm,
                R"([{"op": "replace", "path": "/registers/1/address", "value": 32769}])",
                "/registers/1/address: found 32769, expected an address that "
                "temperature_working_1 does not use"},
        Mistake{kEurotherm,
                R"([{"op": "replace", "path": "/registers/0/address", "value": 65535}])",
                "/registers/0/address: found 65535, expected an address inside 0...65535"},
        Mistake{kEurotherm,
                R"([{"op": "replace", "path": "/registers/0/address", "value": 65536}])",
                "/registers/0/address: found 65536, expected an integer (or \"0x...\") from 0 to "
                "65535"},
        Mistake{kEurotherm,
                R"([{"op": "replace", "path": "/registers/0/address", "value": "0xZZ"}])",
                "/registers/0/address: found \"0xZZ\""},
        Mistake{kEurotherm, R"([{"op": "replace", "path": "/registers/0/type", "value": "uint8"}])",
                "/registers/0/type: found \"uint8\", expected a type of 16 or 32 bits"},
        Mistake{kEurotherm,
                R"([{"op": "replace", "path": "/registers/0/type", "value": "double"}])",
                "/registers/0/type: found \"double\", expected one of \"uint8\", \"int8\""},
        Mistake{kEurotherm, R"([{"op": "replace", "path": "/registers/4/scale", "value": 0}])",
                "/registers/4/scale: found 0, expected a number other than 0"},
        Mistake{kEurotherm,
                R"([{"op": "replace", "path": "/registers/4/access", "value": "read"}])",
                "/registers/4/access: found \"read\", expected \"read_write\""},
        Mistake{kEurotherm, R"([{"op": "add", "path": "/registers/0/access", "value": "write"}])",
                "/registers/0/access: found \"write\", expected a register that can be read"},
        Mistake{kEurotherm, R"([{"op": "replace", "path": "/registers/4/minimum", "value": 71}])",
                "/registers/4/minimum: found 71, expected at most the maximum 70"},
        Mistake{kEurotherm, R"([{"op": "remove", "path": "/modes/boost"}])",
                "/modes: has no \"boost\""},
        Mistake{kEurotherm, R"([{"op": "add", "path": "/modes/auto", "value": 3}])",
                "/modes/auto: unknown mode"},
        Mistake{kEurotherm, R"([{"op": "replace", "path": "/modes/boost", "value": 2}])",
                "expected a number that differs from that of"},
        Mistake{kEurotherm, R"([{"op": "replace", "path": "/modes/boost", "value": 70000}])",
                "/modes/boost: found 70000, expected a number that the register mode can hold"},
        Mistake{kEurotherm, R"([{"op": "replace", "path": "/target_minimum_c", "value": 70}])",
                "/target_minimum_c: found 70, expected less than target_maximum_c 70"},
        Mistake{kEurotherm, R"([{"op": "replace", "path": "/unit_id", "value": 256}])",
                "/unit_id: found 256, expected an integer (or \"0x...\") from 0 to 255"},
        Mistake{kEurotherm, R"([{"op": "replace", "path": "/unit_id", "value": 1.5}])",
                "/unit_id: found 1.5"},
        Mistake{kOmron, R"([{"op": "replace", "path": "/registers/1/type", "value": "int16"}])",
                "/registers/1/type: found \"int16\", expected a type of 32 bits"}));

INSTANTIATE_TEST_SUITE_P(
    Scpi, DeviceMistakes,
    testing::Values(
        Mistake{kCoil, R"([{"op": "replace", "path": "/set", "value": "CURR"}])",
                "/set: found \"CURR\", expected a command with {value}"},
        Mistake{kCoil, R"([{"op": "replace", "path": "/unit", "value": "V"}])",
                "/unit: found \"V\", expected a current in A, mA, uA, or an angle in deg, "},
        Mistake{kCoil, R"([{"op": "replace", "path": "/minimum", "value": 6}])",
                "/minimum: found 6, expected less than the maximum 6"},
        Mistake{kCoil, R"([{"op": "replace", "path": "/minimum", "value": 1}])",
                "/minimum: found 1, expected a range with 0 A in it"},
        Mistake{kCoil, R"([{"op": "remove", "path": "/output_off"}])",
                "/output_off: found nothing, expected output_on and output_off both"},
        Mistake{kCoil, R"([{"op": "add", "path": "/initialise/-", "value": "*tst?"}])",
                "/initialise/4: found \"*tst?\", expected no self test"}));

INSTANTIATE_TEST_SUITE_P(
    Hid, DeviceMistakes,
    testing::Values(
        Mistake{kHid, R"([{"op": "remove", "path": "/fields/2"}])",
                "/fields: has no \"field_z\"; expected field_x, field_y, field_z"},
        Mistake{kHid, R"([{"op": "replace", "path": "/fields/0/offset_bytes", "value": 0}])",
                "/fields/0/offset_bytes: field_x takes byte 0, which the report id has already"},
        Mistake{kHid, R"([{"op": "replace", "path": "/fields/4/offset_bytes", "value": 16}])",
                "/fields/4/offset_bytes: found 16, expected status at bytes 16...16 to lie inside "
                "the report of 16 bytes"},
        Mistake{kHid, R"([{"op": "replace", "path": "/range_ut", "value": 0}])",
                "/range_ut: found 0, expected a number above 0"},
        Mistake{kHid, R"([{"op": "replace", "path": "/calibration/matrix/1", "value": [1, 0, 0]}])",
                "/calibration/matrix: cannot be inverted"}));

INSTANTIATE_TEST_SUITE_P(
    Frame, DeviceMistakes,
    testing::Values(
        Mistake{kKvh, R"([{"op": "replace", "path": "/header", "value": "FE 8"}])",
                "/header: found \"FE 8\", expected bytes in hexadecimal"},
        Mistake{kKvh, R"([{"op": "replace", "path": "/header", "value": ""}])",
                "/header: found \"\", expected bytes in hexadecimal"},
        Mistake{kKvh, R"([{"op": "replace", "path": "/crc/width_bits", "value": 24}])",
                "/crc/width_bits: found 24, expected 8, 16 or 32"},
        Mistake{kKvh, R"([{"op": "replace", "path": "/crc/width_bits", "value": 16}])",
                "/crc/polynomial: found \"0x04C11DB7\", expected a number of 16 bits"},
        Mistake{kKvh, R"([{"op": "replace", "path": "/crc/polynomial", "value": 0}])",
                "/crc/polynomial: found 0, expected a number other than 0"},
        Mistake{kKvh, R"([{"op": "replace", "path": "/crc/count_bytes", "value": 37}])",
                "/crc/count_bytes: found 37, expected the check to cover bytes of the frame only"},
        Mistake{kKvh, R"([{"op": "replace", "path": "/crc/count_bytes", "value": 33}])",
                "/crc/count_bytes: found 33, expected a check that does not cover its own value"},
        Mistake{kKvh, R"([{"op": "replace", "path": "/rate/offset_bytes", "value": 2}])",
                "/rate/offset_bytes: rate_x takes byte 2, which the header has already"},
        Mistake{kKvh, R"([{"op": "add", "path": "/rate/scale", "value": 0}])",
                "/rate/scale: found 0"},
        Mistake{kKvh, R"([{"op": "replace", "path": "/frame_bytes", "value": 35}])",
                "expected the check value at bytes 32...35 to lie inside the frame of 35 bytes"},
        Mistake{kKvh, R"([{"op": "replace", "path": "/frame_rate_hz", "value": 3000}])",
                "/frame_rate_hz: found 3000, expected at most 2560.0: 36 bytes a frame at 921600 "
                "bits a second"},
        Mistake{kKvh, R"([{"op": "replace", "path": "/sequence_modulus", "value": 257}])",
                "/sequence_modulus: found 257, expected at most 256, or a wider sequence_type"},
        Mistake{kKvh, R"([{"op": "add", "path": "/sequence_type", "value": "int16"}])",
                "/sequence_type: found \"int16\", expected uint8, uint16 or uint32"},
        Mistake{kKvh, R"([{"op": "add", "path": "/sequence_type", "value": "uint16"}])",
                "/temperature/offset_bytes: temperature takes byte 30, which the sequence has"},
        Mistake{kKvh, R"([{"op": "remove", "path": "/status_valid_mask"}])",
                "/status_valid_mask: found nothing, expected status_offset_bytes and a"}));

TEST(LoadDevice, KnowsHexadecimalAndDefaults) {
  const auto file = load_device(kReady / kEurotherm);
  ASSERT_TRUE(file) << file.error().message;
  const auto& device = std::get<ModbusDevice>(*file);
  EXPECT_EQ(device.registers[0].address, 0x8002);
  EXPECT_EQ(device.registers[0].type, NumberType::kFloat32);
  EXPECT_EQ(device.registers[4].scale, 0.1);
  EXPECT_EQ(device.registers[4].access, Access::kReadWrite);
  EXPECT_EQ(device.registers[4].maximum, 70.0);
  EXPECT_EQ(device.registers[5].access, Access::kRead);
  EXPECT_FALSE(device.registers[5].maximum.has_value());
}

TEST(LoadDevice, ReadsTheKvhFrame) {
  const auto file = load_device(kReady / kKvh);
  ASSERT_TRUE(file) << file.error().message;
  const auto& device = std::get<FrameDevice>(*file);
  EXPECT_THAT(device.header, ElementsAre(0xFE, 0x81, 0xFF, 0x55));
  EXPECT_EQ(device.rate.scale, 3600.0);
  EXPECT_EQ(device.temperature->offset_bytes, 30);
  EXPECT_EQ(device.crc.initial, 0xFFFFFFFFU);
  EXPECT_EQ(device.sequence_modulus, 128);
}

TEST(CheckDevice, NamesEveryProblemAtOnce) {
  ChangedFile file;
  DeviceFile device;
  const auto problems = check_device(file.write(R"({
    "kind": "modbus", "name": "x", "unit_id": 300, "max_age": 2,
    "registers": [{"name": "target", "address": -1}, {"name": "mode", "type": "int12"}],
    "modes": {"off": 0, "boost": 1, "normal": 2},
    "target_minimum_c": 0})"),
                                     device);
  std::string all;
  for (const Error& problem : problems) {
    EXPECT_EQ(problem.code, ErrorCode::kBadInput);
    EXPECT_EQ(problem.message.find('\n'), std::string::npos);
    all += problem.message + "\n";
  }
  EXPECT_EQ(problems.size(), 7U) << all;
  for (const char* expected :
       {"/unit_id: found 300", "/registers/0/address: found -1", "/registers/1/type: found",
        "/registers/1: has no key \"address\"", "/max_age: unknown key; did you mean",
        "has no key \"target_maximum_c\"",
        "/registers: has no \"temperature_working_1\", \"temperature_working_2\", "}) {
    EXPECT_NE(all.find(expected), std::string::npos) << expected << " in\n" << all;
  }
}

TEST(CheckDevice, NamesEveryDisagreementAtOnceAndUnknownRegisters) {
  ChangedFile file;
  DeviceFile device;
  const auto problems = check_device(file.patch(kEurotherm, R"([
        {"op": "replace", "path": "/registers/2/name", "value": "temprature_control"},
        {"op": "replace", "path": "/registers/4/scale", "value": 0},
        {"op": "add", "path": "/registers/7/unit", "value": "K"},
        {"op": "replace", "path": "/modes/boost", "value": 2},
        {"op": "replace", "path": "/target_minimum_c", "value": 70},
        {"op": "add", "path": "/registers/-", "value": {"name": "door", "address": 900}}])"),
                                     device);
  std::string all;
  for (const Error& problem : problems) all += problem.message + "\n";
  for (const char* expected :
       {"/registers/2/name: unknown register \"temprature_control\"; did you mean "
        "\"temperature_control\"?",
        "/registers: has no \"temperature_control\"", "/registers/4/scale: found 0",
        "/registers/10/name: unknown register \"door\"; known: temperature_working_1",
        "expected a number that differs from that of", "/target_minimum_c: found 70",
        "/registers/7/unit: found \"K\", expected none"}) {
    EXPECT_NE(all.find(expected), std::string::npos) << expected << " in\n" << all;
  }
  EXPECT_EQ(problems.size(), 7U) << all;
}

TEST(CheckDevice, ARegisterThatPeopleOnlyLookAtIsNoMistakeWhereNoneLacks) {
  ChangedFile file;
  DeviceFile device;
  const auto problems =
      check_device(file.patch(kEurotherm,
                              R"([{"op": "add", "path": "/registers/-", "value": {"name": "door",
                     "address": 900}}])"),
                   device);
  EXPECT_TRUE(problems.empty()) << problems.front().message;
}

TEST(CheckDevice, AFrameNeedsNoStatusAndMayCountInSixteenBits) {
  ChangedFile file;
  DeviceFile device;
  const auto problems = check_device(file.write(R"({
    "kind": "frame", "name": "x", "header": "AA 55", "frame_bytes": 12,
    "rate": {"name": "rate", "offset_bytes": 4, "type": "int32", "scale": 1e-9, "unit": "rad/s"},
    "sequence_offset_bytes": 2, "sequence_type": "uint16", "sequence_modulus": 65536,
    "crc": {"width_bits": 32, "polynomial": 79764919, "count_bytes": 8, "offset_bytes": 8},
    "frame_rate_hz": 100})"),
                                     device);
  EXPECT_TRUE(problems.empty()) << problems.front().message;
  const auto& frame = std::get<FrameDevice>(device);
  EXPECT_FALSE(frame.status_offset_bytes);
  EXPECT_EQ(frame.sequence_modulus, 65536U);
  EXPECT_NEAR(frame.rate.scale, 1e-9 * 180.0 / 3.141592653589793 * 3600.0, 1e-12);
}

TEST(CheckDevice, FindsNothingInAReadyOne) {
  DeviceFile device;
  EXPECT_TRUE(
      check_device(tests::source_tree() / "config/devices/coil-kepco.json", device).empty());
  EXPECT_TRUE(std::holds_alternative<ScpiDevice>(device));
}

}  // namespace
}  // namespace fogbench::config
