#include "drivers/modbus_thermostat.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "drivers/number_codec.hpp"
#include "tests/support/fake_transports.hpp"

namespace fogbench::drivers {
namespace {

using namespace std::chrono_literals;
using config::Access;

class ModbusThermostatTest : public testing::Test {
 protected:
  ModbusThermostatTest() {
    device_.name = "test map";
    device_.registers = {
        {.name = "temperature_working_1", .address = 10, .type = NumberType::kFloat32},
        {.name = "temperature_working_2", .address = 12, .type = NumberType::kFloat32},
        {.name = "temperature_control", .address = 14, .type = NumberType::kFloat32},
        {.name = "temperature_ambient", .address = 100, .scale = 0.1, .unit = "degC"},
        {.name = "target",
         .address = 2,
         .scale = 0.1,
         .access = Access::kReadWrite,
         .unit = "degC",
         .maximum = 60.0},
        {.name = "mode", .address = 3, .type = NumberType::kUint16, .access = Access::kReadWrite},
        {.name = "boost_power", .address = 101, .scale = 0.01, .unit = "W"},
        {.name = "normal_power", .address = 103, .scale = 0.01, .unit = "W"},
    };
    device_.modes = {{"off", 0}, {"boost", 7}, {"normal", 9}};
    device_.target_maximum = Celsius{70.0};
    write("temperature_working_1", 31.5);
    write("temperature_working_2", 31.25);
    write("temperature_control", 31.0);
    write("temperature_ambient", 21.3);
    write("target", 35.0);
    write("mode", 9);
    write("boost_power", 6.5);
    write("normal_power", 3.25);
  }
  RegisterSpec& spec(std::string_view name) {
    return *std::find_if(device_.registers.begin(), device_.registers.end(),
                         [&](const RegisterSpec& s) { return s.name == name; });
  }
  void write(std::string_view name, double value) {
    const RegisterSpec& s = spec(name);
    std::vector<std::uint16_t> words(word_count(s.type));
    ASSERT_TRUE(write_words(s, value, words));
    for (std::size_t i = 0; i < words.size(); ++i) {
      far_.words[static_cast<std::uint16_t>(s.address + i)] = words[i];
    }
  }
  Result<std::unique_ptr<ModbusThermostat>> open() {
    return begun(ModbusThermostat::attach("thermostat", device_,
                                          std::make_unique<support::FakeModbus>(far_), clock_));
  }
  std::unique_ptr<ModbusThermostat> opened() {
    auto thermostat = open();
    EXPECT_TRUE(thermostat) << thermostat.error().message;
    far_.log.clear();
    return std::move(*thermostat);
  }

  VirtualClock clock_;
  config::ModbusDevice device_;
  support::FakeRegisters far_;
  const Error timeout_{ErrorCode::kTimeout, "no answer in 500 ms"};
};

TEST_F(ModbusThermostatTest, ReadsEveryQuantityWithNeighboursTogether) {
  const auto thermostat = opened();
  clock_.sleep_for(3s);
  const auto reading = thermostat->read();
  ASSERT_TRUE(reading) << reading.error().message;
  EXPECT_EQ(reading->working_1, Celsius{31.5});
  EXPECT_EQ(reading->working_2, Celsius{31.25});
  EXPECT_EQ(reading->control, Celsius{31.0});
  EXPECT_NEAR(reading->ambient.value, 21.3, 1e-9);
  EXPECT_EQ(reading->target, Celsius{35.0});
  EXPECT_EQ(reading->mode, HeatingMode::kNormal);
  EXPECT_NEAR(reading->boost_power.value, 6.5, 1e-9);
  EXPECT_NEAR(reading->normal_power.value, 3.25, 1e-9);
  EXPECT_EQ(reading->taken_at, clock_.now());
  EXPECT_EQ(far_.log,
            (std::vector<std::string>{"read 2+2", "read 10+6", "read 100+2", "read 103+1"}));
  EXPECT_EQ(*thermostat->identity(), "test map");
}

TEST_F(ModbusThermostatTest, SetsTargetAndModeAndReadsThemBack) {
  const auto thermostat = opened();
  ASSERT_TRUE(thermostat->set_target(Celsius{40.04}));
  EXPECT_EQ(far_.words[2], 400);
  ASSERT_TRUE(thermostat->set_mode(HeatingMode::kBoost));
  EXPECT_EQ(far_.words[3], 7);
  EXPECT_EQ(far_.log, (std::vector<std::string>{"write 2+1", "read 2+1", "write 3+1", "read 3+1"}));
  EXPECT_EQ(thermostat->read()->mode, HeatingMode::kBoost);
}

TEST_F(ModbusThermostatTest, RefusesATargetBeyondEitherLimitBeforeTheWire) {
  const auto thermostat = opened();
  for (const double target : {-0.5, 60.5, 1e9, std::nan("")}) {
    const Status status = thermostat->set_target(Celsius{target});
    ASSERT_FALSE(status);
    EXPECT_EQ(status.error().code, ErrorCode::kLimit);
  }
  EXPECT_EQ(thermostat->set_target(Celsius{60.5}).error().message,
            "thermostat: target 60.5 degC is outside 0 ... 60 degC");
  EXPECT_TRUE(far_.log.empty());
}

TEST_F(ModbusThermostatTest, AWriteThatWasExecutedWithoutAnAnswerIsNotRepeated) {
  const auto thermostat = opened();
  far_.write_failures = {{timeout_, true}};
  EXPECT_TRUE(thermostat->set_target(Celsius{45.0}));
  EXPECT_EQ(far_.count("write"), 1u);
}

TEST_F(ModbusThermostatTest, AWriteThatWasLostIsRepeatedAfterReadingBack) {
  const auto thermostat = opened();
  far_.write_failures = {{timeout_, false}};
  EXPECT_TRUE(thermostat->set_target(Celsius{45.0}));
  EXPECT_EQ(far_.log, (std::vector<std::string>{"write 2+1", "read 2+1", "write 2+1", "read 2+1"}));
}

TEST_F(ModbusThermostatTest, WritesThatAreAlwaysLostEndInATimeout) {
  const auto thermostat = opened();
  far_.write_failures = {{timeout_}, {timeout_}, {timeout_}, {timeout_}};
  const Status status = thermostat->set_target(Celsius{45.0});
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kTimeout);
  EXPECT_EQ(status.error().message,
            "thermostat: writing 45 degC to register target at 2: no answer in 500 ms");
  EXPECT_EQ(far_.count("write"), 3u);
}

TEST_F(ModbusThermostatTest, ARefusedWriteIsFinal) {
  const auto thermostat = opened();
  far_.write_failures = {{{ErrorCode::kDevice, "Modbus exception 3"}}};
  const Status status = thermostat->set_mode(HeatingMode::kOff);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kDevice);
  EXPECT_EQ(far_.log, std::vector<std::string>{"write 3+1"});
}

TEST_F(ModbusThermostatTest, AValueThatIsNotKeptIsADeviceError) {
  const auto thermostat = opened();
  far_.before_read = [&] { far_.words[2] = 210; };
  const Status status = thermostat->set_target(Celsius{45.0});
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kDevice);
  EXPECT_EQ(status.error().message,
            "thermostat: register target at 2 was set to 45 degC but reads back 21 degC");
}

TEST_F(ModbusThermostatTest, ALostReadIsRepeatedTwiceAndNoMore) {
  const auto thermostat = opened();
  far_.read_failures = {timeout_, {ErrorCode::kProtocol, "wrong check value"}};
  EXPECT_TRUE(thermostat->read());
  far_.read_failures = {timeout_, timeout_, timeout_};
  const auto reading = thermostat->read();
  ASSERT_FALSE(reading);
  EXPECT_EQ(reading.error().code, ErrorCode::kTimeout);
  EXPECT_EQ(reading.error().message, "thermostat: reading registers 2 ... 3: no answer in 500 ms");
}

TEST_F(ModbusThermostatTest, AConnectionThatWasClosedIsUsedAgainAtOnce) {
  const auto thermostat = opened();
  const Error closed{ErrorCode::kUnplugged, "closed"};
  far_.read_failures = {closed};
  EXPECT_TRUE(thermostat->read());
  far_.read_failures = {closed, closed, closed};
  EXPECT_EQ(thermostat->read().error().code, ErrorCode::kUnplugged);
}

TEST_F(ModbusThermostatTest, ABusyControllerIsAskedAgainWithAPause) {
  const auto thermostat = opened();
  const Error busy{ErrorCode::kBusy, "Modbus exception 6 (device busy)"};
  const auto begun = clock_.now();
  far_.read_failures = {busy, busy, busy};
  EXPECT_TRUE(thermostat->read());
  EXPECT_GE(clock_.now() - begun, 300ms);
  far_.write_failures = {{busy}, {busy}, {busy}, {busy}};
  EXPECT_TRUE(thermostat->set_mode(HeatingMode::kOff));
  EXPECT_EQ(far_.words[3], 0);
}

TEST_F(ModbusThermostatTest, WhatIsStillAtWorkIsNotWrittenTwice) {
  const auto thermostat = opened();
  far_.write_failures = {{{ErrorCode::kBusy, "Modbus exception 5"}, true}};
  EXPECT_TRUE(thermostat->set_target(Celsius{45.0}));
  EXPECT_EQ(far_.count("write"), 1u);
}

TEST_F(ModbusThermostatTest, OneThatStaysBusyIsAnErrorWithItsExceptionAndTheTime) {
  const auto thermostat = opened();
  const Error busy{ErrorCode::kBusy, "Modbus exception 6"};
  far_.read_failures.assign(1000, busy);
  EXPECT_EQ(thermostat->read().error().message,
            "thermostat: reading registers 2 ... 3: Modbus exception 6, for 1.0 s");
  far_.read_failures.clear();
  far_.write_failures.assign(1000, {busy});
  const Status written = thermostat->set_target(Celsius{45.0});
  EXPECT_EQ(written.error().code, ErrorCode::kBusy);
  EXPECT_EQ(written.error().message,
            "thermostat: writing 45 degC to register target at 2: Modbus exception 6, for 10.0 s");
}

TEST_F(ModbusThermostatTest, WhoAnswersReadsButNoWritesIsNotGone) {
  const auto thermostat = opened();
  const Error closed{ErrorCode::kUnplugged, "closed"};
  far_.write_failures = {{closed}, {closed}, {closed}};
  EXPECT_EQ(thermostat->set_mode(HeatingMode::kOff).error().code, ErrorCode::kDevice);
}

TEST_F(ModbusThermostatTest, AnExceptionAnswerIsNotRepeated) {
  const auto thermostat = opened();
  far_.read_failures = {{ErrorCode::kDevice, "Modbus exception 4"}};
  const auto reading = thermostat->read();
  ASSERT_FALSE(reading);
  EXPECT_EQ(reading.error().code, ErrorCode::kDevice);
  EXPECT_EQ(far_.log.size(), 1u);
}

TEST_F(ModbusThermostatTest, NanOfABrokenSensorIsAProtocolErrorThatNamesItsRegister) {
  const auto thermostat = opened();
  far_.words[12] = 0x7fc0;
  far_.words[13] = 0;
  const auto reading = thermostat->read();
  ASSERT_FALSE(reading);
  EXPECT_EQ(reading.error().code, ErrorCode::kProtocol);
  EXPECT_EQ(
      reading.error().message,
      "thermostat: register temperature_working_2 at 12: reads nan, expected a finite number");
}

TEST_F(ModbusThermostatTest, AnUnknownModeIsAProtocolError) {
  const auto thermostat = opened();
  far_.words[3] = 4;
  const auto reading = thermostat->read();
  ASSERT_FALSE(reading);
  EXPECT_EQ(reading.error().code, ErrorCode::kProtocol);
  EXPECT_EQ(reading.error().message,
            "thermostat: register mode at 3 reads 4, expected 0 (off), 7 (boost), 9 (normal)");
}

TEST_F(ModbusThermostatTest, AReadingThatTookTooLongIsStale) {
  const auto thermostat = opened();
  far_.before_read = [&] { clock_.sleep_for(600ms); };
  const auto reading = thermostat->read();
  ASSERT_FALSE(reading);
  EXPECT_EQ(reading.error().code, ErrorCode::kStale);
}

TEST_F(ModbusThermostatTest, TheOtherWordOrderReadsAbsurdlySmall) {
  for (const char* name : {"temperature_working_1", "temperature_working_2"}) {
    spec(name).word_order = WordOrder::kLowFirst;
  }
  const auto thermostat = opened();
  EXPECT_LT(std::abs(thermostat->read()->working_1.value), 1e-30);
}

TEST_F(ModbusThermostatTest, AnInstrumentOfEvenCountsGetsEvenCounts) {
  device_.even_counts_only = true;
  const auto refused = open();
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kBadInput);

  std::uint16_t address = 0;
  far_.words.clear();
  far_.even_counts_only = true;
  for (RegisterSpec& s : device_.registers) {
    s.type = NumberType::kInt32;
    s.address = address;
    address = static_cast<std::uint16_t>(address + (s.name == "mode" ? 6 : 2));
    write(s.name, s.name == "mode" ? 7 : 20.0);
  }
  const auto thermostat = opened();
  EXPECT_EQ(thermostat->read()->mode, HeatingMode::kBoost);
  EXPECT_TRUE(thermostat->set_target(Celsius{30.0}));
}

TEST_F(ModbusThermostatTest, AMapWithoutARegisterOrAModeIsBadInput) {
  device_.modes.erase("boost");
  auto thermostat = open();
  ASSERT_FALSE(thermostat);
  EXPECT_EQ(thermostat.error().code, ErrorCode::kBadInput);
  EXPECT_EQ(thermostat.error().message, "thermostat: the map test map has no value for mode boost");
  device_.registers.pop_back();
  thermostat = open();
  ASSERT_FALSE(thermostat);
  EXPECT_EQ(thermostat.error().message,
            "thermostat: the map test map has no register normal_power");
  EXPECT_TRUE(far_.log.empty());
}

TEST_F(ModbusThermostatTest, TwoQuantitiesMayShareARegister) {
  spec("temperature_ambient").address = 4;
  spec("boost_power").address = 4;
  write("temperature_ambient", 20.0);
  const auto thermostat = opened();
  EXPECT_NEAR(thermostat->read()->boost_power.value, 2.0, 1e-9);
}

TEST_F(ModbusThermostatTest, ANumberThatARegisterCannotSensiblyHoldIsAProtocolError) {
  spec("temperature_control").minimum = 5.0;
  spec("temperature_control").maximum = 120.0;
  spec("temperature_control").unit = "degC";
  const auto thermostat = opened();
  for (const double value : {1e-20, -3.0, 1e34}) {
    write("temperature_control", value);
    const auto reading = thermostat->read();
    ASSERT_FALSE(reading) << value;
    EXPECT_EQ(reading.error().code, ErrorCode::kProtocol);
    EXPECT_NE(reading.error().message.find("expected 5 ... 120 degC"), std::string::npos)
        << reading.error().message;
  }
  write("temperature_control", 31.0);
  EXPECT_TRUE(thermostat->read());
}

TEST_F(ModbusThermostatTest, ATargetThatRoundsBeyondALimitIsRefusedBeforeTheWire) {
  spec("target").maximum = 60.06;
  const auto thermostat = opened();
  const Status status = thermostat->set_target(Celsius{60.055});  // 60.1 in tenths
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kLimit);
  EXPECT_TRUE(far_.log.empty());
}

TEST_F(ModbusThermostatTest, TemperaturesThatStandStillAreStaleWhereTheyMayNot) {
  device_.stuck_after = config::Seconds{3.0};
  const auto thermostat = opened();
  for (int second = 1; second < 3; ++second) {
    clock_.sleep_for(1s);
    EXPECT_TRUE(thermostat->read()) << second;
  }
  clock_.sleep_for(1s);
  const auto reading = thermostat->read();
  ASSERT_FALSE(reading);
  EXPECT_EQ(reading.error().code, ErrorCode::kStale);
  EXPECT_EQ(reading.error().message, "thermostat: no temperature has moved by a bit for 3.0 s");
  write("temperature_ambient", 21.4);
  EXPECT_TRUE(thermostat->read());
}

TEST_F(ModbusThermostatTest, IsSwitchedOffByOneWriteAndBelievedByItsReadBack) {
  const auto thermostat = opened();
  ASSERT_TRUE(thermostat->switch_off());
  EXPECT_EQ(far_.log, (std::vector<std::string>{"write 3+1"}));
  write("boost_power", 0.0);
  write("normal_power", 0.0);
  EXPECT_TRUE(thermostat->confirm_off());
}

TEST_F(ModbusThermostatTest, IsSwitchedOffWhateverItsSensorsAndItsModeSay) {
  far_.words[spec("temperature_working_1").address] = 0x7FC0;  // not a number
  write("temperature_ambient", -200.0);
  write("mode", 42.0);  // somebody's manual mode
  write("boost_power", 0.0);
  write("normal_power", 0.0);
  auto thermostat = ModbusThermostat::attach("thermostat", device_,
                                             std::make_unique<support::FakeModbus>(far_), clock_);
  ASSERT_TRUE(thermostat) << thermostat.error().message;
  EXPECT_FALSE((*thermostat)->begin());
  EXPECT_TRUE((*thermostat)->switch_off());
  EXPECT_TRUE((*thermostat)->confirm_off());
  EXPECT_EQ(far_.words[3], 0);
}

TEST_F(ModbusThermostatTest, IsNotOffWhileItsHeatersDrawPower) {
  const auto thermostat = opened();
  ASSERT_TRUE(thermostat->switch_off());
  const Clock::Instant asked = clock_.now();
  const Status off = thermostat->confirm_off();
  ASSERT_FALSE(off);
  EXPECT_NE(off.error().message.find("the heaters still draw 9.8 W"), std::string::npos)
      << off.error().message;
  EXPECT_EQ(clock_.now() - asked, 900ms) << "a controller is given time to refresh its registers";
}

TEST_F(ModbusThermostatTest, IsNotOffWhileItsModeReadsBackOtherwise) {
  const auto thermostat = opened();
  far_.write_failures.push_back({timeout_, false});
  EXPECT_EQ(thermostat->switch_off().error().code, ErrorCode::kTimeout);
  EXPECT_EQ(thermostat->confirm_off().error().code, ErrorCode::kDevice);
}

}  // namespace
}  // namespace fogbench::drivers
