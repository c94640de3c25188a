// A unit that a device file states has its effect, wherever it may stand; what cannot be one is
// refused in a line that lists those that can.

#include "config/house_units.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/device_file.hpp"
#include "tests/config/changed_file.hpp"

namespace fogbench::config {
namespace {

using testing::HasSubstr;

/// The ready file with keys put in: {{"/rate/unit", "\"rad/s\""}}.
Result<DeviceFile> load_with(const std::string& name,
                             std::initializer_list<std::pair<const char*, const char*>> keys) {
  ChangedFile file;
  std::string patch;
  for (const auto& [pointer, value] : keys) {
    patch += fmt::format(R"({}{{"op": "add", "path": "{}", "value": {}}})",
                         patch.empty() ? "" : ", ", pointer, value);
  }
  return load_device(file.patch("devices/" + name, "[" + patch + "]"));
}

template <class Device>
Device loaded(const std::string& name,
              std::initializer_list<std::pair<const char*, const char*>> keys) {
  const auto device = load_with(name, keys);
  if (!device) {
    ADD_FAILURE() << device.error().message;
    return {};
  }
  return std::get<Device>(*device);
}

TEST(HouseUnits, AGyrosRateIsInDegreesAnHourWhateverItsFileStates) {
  EXPECT_DOUBLE_EQ(loaded<FrameDevice>("gyro-crc8.json", {{"/rate/unit", R"("deg/s")"}}).rate.scale,
                   0.36);
  const auto gyro = loaded<FrameDevice>("gyro-crc8.json",
                                        {{"/rate/unit", R"("arcsec/s")"}, {"/rate/offset", "2"}});
  EXPECT_EQ(gyro.rate.scale, 0.0001);
  EXPECT_EQ(gyro.rate.offset, 2.0);
  EXPECT_EQ(gyro.rate.unit, "deg/h");
}

TEST(HouseUnits, ATemperatureWithAnOffsetKeepsItsMeaningAndItsLimits) {
  // -40 degF ... 250 degF, a count of 0.1 degF from 10 degF on.
  const auto thermostat =
      loaded<ModbusDevice>("thermostat-eurotherm.json", {{"/registers/0/unit", R"("degF")"},
                                                         {"/registers/0/scale", "0.1"},
                                                         {"/registers/0/offset", "10"},
                                                         {"/registers/0/minimum", "-40"},
                                                         {"/registers/0/maximum", "250"}});
  const RegisterSpec& r = thermostat.registers[0];
  EXPECT_EQ(r.unit, "degC");
  EXPECT_NEAR(r.scale, 0.1 * 5.0 / 9.0, 1e-12);
  EXPECT_NEAR(580.0 * r.scale + r.offset, (68.0 - 32.0) * 5.0 / 9.0, 1e-9);
  EXPECT_NEAR(*r.minimum, -40.0, 1e-9);
  EXPECT_NEAR(*r.maximum, 121.111111, 1e-6);
}

TEST(HouseUnits, ASupplySpokenToInMilliamperesHasItsLimitsInAmperes) {
  const auto supply = loaded<ScpiDevice>("coil-kepco.json", {{"/unit", R"("mA")"},
                                                             {"/minimum", "-6000"},
                                                             {"/maximum", "6000"},
                                                             {"/resolution", "0.183"},
                                                             {"/read_back_tolerance", "5"}});
  EXPECT_EQ(supply.unit, "A");
  EXPECT_EQ(supply.scale, 0.001);
  EXPECT_EQ(supply.minimum, -6.0);
  EXPECT_EQ(supply.maximum, 6.0);
  EXPECT_NEAR(supply.resolution, 0.000183, 1e-12);
  EXPECT_NEAR(supply.read_back_tolerance, 0.005, 1e-12);
}

TEST(HouseUnits, WithoutAUnitANumberIsInTheHousesAlready) {
  ChangedFile file;
  const auto device =
      load_device(file.patch("devices/gyro-crc8.json", R"([{"op": "remove", "path": "/rate/unit"},
                                               {"op": "remove", "path": "/temperature/unit"}])"));
  ASSERT_TRUE(device) << device.error().message;
  const auto& gyro = std::get<FrameDevice>(*device);
  EXPECT_EQ(gyro.rate.scale, 0.0001);
  EXPECT_EQ(gyro.rate.unit, "deg/h");
  EXPECT_EQ(gyro.temperature->unit, "degC");
}

TEST(HouseUnits, WhatNoDriverAsksForMayHaveAnyKnownUnitAndIsShownInTheHouses) {
  const auto gyro = loaded<FrameDevice>("gyro-kvh.json", {{"/others/2/unit", R"("m/s^2")"}});
  EXPECT_EQ(gyro.others[2].unit, "g");
  EXPECT_NEAR(gyro.others[2].scale, 1.0 / 9.80665, 1e-12);
  EXPECT_THAT(message_of(load_with("gyro-kvh.json", {{"/others/2/unit", R"("furlong")"}})),
              HasSubstr("/others/2/unit: found \"furlong\", expected one of deg/h, "));
}

struct Refused {
  const char* file;
  const char* pointer;
  const char* unit;
  const char* expected;
};
class RefusedUnits : public testing::TestWithParam<Refused> {};

TEST_P(RefusedUnits, AreNamedWithThoseThatAreKnown) {
  const auto& [file, pointer, unit, expected] = GetParam();
  EXPECT_THAT(message_of(load_with(file, {{pointer, unit}})),
              HasSubstr(fmt::format("{}: found {}, expected {}", pointer, unit, expected)));
}

INSTANTIATE_TEST_SUITE_P(
    EveryPlaceForOne, RefusedUnits,
    testing::Values(
        Refused{"gyro-kvh.json", "/rate/unit", R"("banana")", "a rotation rate in deg/h, deg/min"},
        Refused{"gyro-kvh.json", "/rate/unit", R"("degC")", "a rotation rate in deg/h"},
        Refused{"gyro-kvh.json", "/rate/unit", R"("")", "a text of one line that is not empty"},
        Refused{"gyro-kvh.json", "/temperature/unit", R"("deg/s")", "a temperature in degC, mdegC"},
        Refused{"magnetometer-hid.json", "/fields/0/unit", R"("A")", "a magnetic field in uT, nT"},
        Refused{"magnetometer-hid.json", "/fields/3/unit", R"("uT")", "none: sequence is a count"},
        Refused{"magnetometer-hid.json", "/fields/4/scale", "2", "none: status is a count"},
        Refused{"thermostat-omron.json", "/registers/0/unit", R"("W")", "a temperature in degC"},
        Refused{"thermostat-omron.json", "/registers/3/unit", R"("degC")", "a power in W, mW, kW"},
        Refused{"thermostat-omron.json", "/registers/8/unit", R"("deg")", "a temperature in degC"},
        Refused{"thermostat-omron.json", "/registers/9/unit", R"("degC")", "none: mode is a count"},
        Refused{"coil-kepco.json", "/unit", R"("degC")", "a current in A, mA, uA, or an angle in"},
        Refused{"turntable-scpi.json", "/unit", R"("turns")", "a current in A"}));

}  // namespace
}  // namespace fogbench::config
