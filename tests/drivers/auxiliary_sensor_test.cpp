// The drivers of auxiliary sensors on the far ends of the simulated bench: both read the same
// descriptions, each kind with its own wire.

#include "drivers/auxiliary_sensor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/scenario.hpp"
#include "simulator/simulated_bench.hpp"
#include "tests/support/source_tree.hpp"

namespace fogbench::drivers {
namespace {

using namespace std::chrono_literals;
using config::FaultKind;
using testing::HasSubstr;

class AuxiliarySensorTest : public testing::Test {
 protected:
  AuxiliarySensorTest()
      : config_(
            *config::load_bench(tests::source_tree() / "config/benches/simulated-auxiliary.json")) {
  }

  std::unique_ptr<AuxiliarySensor> attach(const std::string& name) {
    auto ends = simulator::simulate_bench(config_, scenario_, 1, clock_);
    EXPECT_TRUE(ends) << ends.error().message;
    for (std::size_t i = 0; i < config_.auxiliary.size(); ++i) {
      if (config_.auxiliary[i].name != name) continue;
      auto sensor = attach_sensor(config_.auxiliary[i], std::move(ends->auxiliary[i]), clock_);
      EXPECT_TRUE(sensor) << sensor.error().message;
      return std::move(*sensor);
    }
    return nullptr;
  }
  void add_fault(const std::string& device, FaultKind kind, double at_s, double for_s) {
    scenario_.faults.push_back({device, kind, config::Seconds{at_s}, config::Seconds{for_s}});
  }

  VirtualClock clock_;
  config::BenchConfig config_;
  config::ScenarioConfig scenario_;
};

TEST_F(AuxiliarySensorTest, EveryKindReadsWhatIsTrue) {
  for (const auto& [name, expected] :
       std::vector<std::pair<std::string, std::vector<double>>>{{"barometer", {1013.0, 22.0}},
                                                                {"voltmeter", {5.0}},
                                                                {"hygrometer", {45.0}},
                                                                {"light_meter", {300.0}}}) {
    const auto sensor = attach(name);
    const auto values = sensor->read();
    ASSERT_EQ(values.size(), expected.size()) << name;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      ASSERT_TRUE(values[i]) << values[i].error().message;
      EXPECT_NEAR(*values[i], expected[i], 0.02 * expected[i]) << name;
    }
    EXPECT_TRUE(sensor->identity()) << name;
  }
}

TEST_F(AuxiliarySensorTest, EveryKindFollowsTheQuantityAndNotTheLastReading) {
  for (config::AuxiliaryConfig& sensor : config_.auxiliary) {
    std::visit(
        [](auto& device) {
          for (auto& channel : device.channels) channel.simulated.period = config::Seconds{400.0};
        },
        sensor.device);
  }
  for (const config::AuxiliaryConfig& its : config_.auxiliary) {
    const auto sensor = attach(its.name);
    const auto before = sensor->read();
    clock_.sleep_for(100s);
    const auto after = sensor->read();
    const config::SimulatedQuantity goes = sensor->channels().front().simulated;
    ASSERT_TRUE(before[0] && after[0]) << its.name;
    EXPECT_NEAR(*after[0] - *before[0], goes.swing, 0.1 * goes.swing + 6.0 * goes.noise)
        << its.name;
  }
}

TEST_F(AuxiliarySensorTest, OneThatIsGoneSaysSoAndComesBack) {
  for (const char* name : {"barometer", "voltmeter", "hygrometer", "light_meter"}) {
    scenario_.faults.clear();
    const auto start = to_seconds(clock_.now().time_since_epoch());
    add_fault(name, FaultKind::kUnplug, 10.0, 20.0);
    const auto sensor = attach(name);
    ASSERT_TRUE(sensor->read().front()) << name;
    clock_.sleep_for(15s);
    for (const auto& value : sensor->read()) {
      ASSERT_FALSE(value) << name;
      EXPECT_EQ(value.error().code, ErrorCode::kUnplugged) << value.error().message;
      EXPECT_THAT(value.error().message, HasSubstr(name));
    }
    clock_.sleep_for(20s);
    const auto back = sensor->read();
    EXPECT_TRUE(back.front()) << name << " after " << start << ": " << back.front().error().message;
  }
}

TEST_F(AuxiliarySensorTest, WhatCannotBeIsNoReading) {
  add_fault("voltmeter", FaultKind::kNan, 0.0, 1e6);
  add_fault("hygrometer", FaultKind::kNan, 0.0, 1e6);
  for (const char* name : {"voltmeter", "hygrometer"}) {
    const auto value = attach(name)->read().front();
    ASSERT_FALSE(value) << name;
    EXPECT_EQ(value.error().code, ErrorCode::kProtocol) << value.error().message;
  }
  auto& barometer = std::get<config::ModbusSensor>(config_.auxiliary[0].device);
  barometer.channels[0].maximum = 900.0;
  const auto values = attach("barometer")->read();
  ASSERT_FALSE(values[0]);
  EXPECT_EQ(values[0].error().code, ErrorCode::kLimit);
  EXPECT_THAT(values[0].error().message, HasSubstr("barometer: pressure_hpa reads 101"));
  EXPECT_TRUE(values[1]) << "the other channel is as good as before";
}

TEST_F(AuxiliarySensorTest, AStrangerAtTheOtherEndIsNotRead) {
  std::get<config::ScpiSensor>(config_.auxiliary[1].device).identity = "NOBODY";
  auto ends = simulator::simulate_bench(config_, scenario_, 1, clock_);
  ASSERT_TRUE(ends);
  config::AuxiliaryConfig expected = config_.auxiliary[1];
  std::get<config::ScpiSensor>(expected.device).identity = "34461A";
  const auto sensor = attach_sensor(expected, std::move(ends->auxiliary[1]), clock_);
  ASSERT_TRUE(sensor) << sensor.error().message;
  const auto value = (*sensor)->read().front();
  ASSERT_FALSE(value);
  EXPECT_THAT(value.error().message, HasSubstr("says that it is NOBODY, expected 34461A"));
}

TEST_F(AuxiliarySensorTest, AWayOfAnotherKindIsRefused) {
  auto ends = simulator::simulate_bench(config_, scenario_, 1, clock_);
  ASSERT_TRUE(ends);
  const auto sensor = attach_sensor(config_.auxiliary[0], std::move(ends->auxiliary[1]), clock_);
  ASSERT_FALSE(sensor);
  EXPECT_EQ(sensor.error().code, ErrorCode::kBadInput);
}

}  // namespace
}  // namespace fogbench::drivers
