// The bench as a whole: what it refuses, and that one seed is one bench.

#include "simulator/simulated_bench.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/simulator/test_bench.hpp"

namespace fogbench::simulator {
namespace {

using config::FaultKind;
using namespace std::chrono_literals;

void expect_refused(const config::BenchConfig& bench, const config::ScenarioConfig& scenario,
                    const std::string& says) {
  drivers::VirtualClock clock;
  const auto ends = simulate_bench(bench, scenario, 1, clock);
  ASSERT_FALSE(ends) << says;
  EXPECT_EQ(ends.error().code, ErrorCode::kBadInput);
  EXPECT_NE(ends.error().message.find(says), std::string::npos) << ends.error().message;
}

TEST(SimulatedBench, RefusesWhatItCannotSimulate) {
  config::BenchConfig by_hand = test_bench();
  by_hand.turntable.motorised = false;
  by_hand.turntable.device.reset();
  by_hand.magnetometer.fitted = false;
  for (const char* device : {"turntable", "magnetometer"}) {
    expect_refused(by_hand, {.faults = {fault(device, FaultKind::kTimeout, 0, 1)}},
                   std::string("no device \"") + device + "\"; the bench has thermostat");
  }
  config::BenchConfig bad_step = test_bench();
  bad_step.simulation.step = config::Seconds{0.0};
  expect_refused(bad_step, {}, "simulation step");
  expect_refused(test_bench(), {.terms = {{"nothing", 1.0}}}, "unknown effect");
  expect_refused(test_bench(), {.faults = {fault("gyroscope", FaultKind::kNan, 0, 1)}},
                 "no device \"gyroscope\"");
  for (const char* device : {"gyro", "magnetometer"}) {
    expect_refused(test_bench(), {.faults = {fault(device, FaultKind::kSilentExecution, 0, 1)}},
                   "cannot have the fault silent_execution; it can:");
  }
  for (const char* device : {"magnetometer", "coil_horizontal", "coil_vertical", "turntable"}) {
    expect_refused(test_bench(), {.faults = {fault(device, FaultKind::kBadChecksum, 0, 1)}},
                   "cannot have the fault bad_checksum");
  }
}

/// Everything that all instruments say in two hours of a busy bench.
std::string two_hours(std::uint64_t seed, const std::vector<config::FaultSpec>& faults) {
  config::ScenarioConfig scenario;
  scenario.noise = {0.005, 0.02, 0.02, 0.0};
  scenario.hidden = {{"magnetic_hysteresis_y", 0.1, {{"width", 0.3}}}};
  scenario.faults = faults;
  config::BenchConfig config = test_bench(10.0);
  config.simulation.magnetic.ambient_steps_per_h = 5.0;
  TestFarEnds bench(config, scenario, seed);
  auto& [thermostat, horizontal, vertical, magnetometer, turntable, gyro, auxiliary, turned,
         exchange] = bench.ends;
  EXPECT_TRUE(auxiliary.empty());
  std::string log;
  const std::uint16_t target[] = {350};
  const std::uint16_t boost[] = {1};
  EXPECT_TRUE(thermostat->write_registers(2, target));
  EXPECT_TRUE(thermostat->write_registers(273, boost));
  EXPECT_TRUE(vertical->write("OUTP ON"));
  for (int i = 0; i < 720; ++i) {
    bench.clock.sleep_until(drivers::Clock::Instant{i * 10s});
    std::uint16_t registers[7] = {};
    std::uint8_t report[16] = {};
    std::byte bytes[8192];
    if (!thermostat->read_registers(0x100, registers)) log += "!";
    for (const std::uint16_t word : registers) log += std::to_string(word) + ' ';
    EXPECT_TRUE(vertical->write("CURR " + std::to_string(i % 3 - 1) + ";MEAS:CURR?"));
    log += *vertical->read(1s);
    EXPECT_TRUE(magnetometer->read_report(report, 1s));
    log.append(reinterpret_cast<const char*>(report), sizeof report);
    if (i == 300) {
      EXPECT_TRUE(turntable->write("POS 90"));
    }
    const auto count = gyro->read_some(bytes);
    log.append(reinterpret_cast<const char*>(bytes), *count);
  }
  return log;
}

TEST(SimulatedBench, OneSeedGivesTheSameBytesForTwoHours) {
  const std::string first = two_hours(5, {});
  EXPECT_GT(first.size(), 2000000U);
  EXPECT_TRUE(first == two_hours(5, {}));
  EXPECT_FALSE(first == two_hours(6, {}));
}

TEST(SimulatedBench, AFaultOfOneInstrumentChangesNoOther) {
  const auto gyro_bytes = [](std::vector<config::FaultSpec> faults) {
    config::ScenarioConfig scenario;
    scenario.noise = {0.005, 0.02, 0.02, 0.0};
    scenario.faults = std::move(faults);
    TestFarEnds bench(test_bench(), scenario, 5);
    std::uint16_t word[1];
    (void)bench.ends.thermostat->read_registers(2, word);
    bench.clock.sleep_until(drivers::Clock::Instant{100s});
    std::vector<std::byte> bytes(1U << 20U);
    bytes.resize(*bench.ends.gyro->read_some(bytes));
    return bytes;
  };
  EXPECT_EQ(gyro_bytes({}), gyro_bytes({fault("thermostat", FaultKind::kGarbage, 0, 50),
                                        fault("magnetometer", FaultKind::kNan, 0, 50)}));
}

}  // namespace
}  // namespace fogbench::simulator
