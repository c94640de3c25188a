// The thermostat at its registers.

#include <gtest/gtest.h>

#include <bit>
#include <vector>

#include "tests/simulator/test_bench.hpp"

namespace fogbench::simulator {
namespace {

class ModbusFarEndTest : public ::testing::Test {
 protected:
  static void expect(const Status& status, ErrorCode code, const std::string& says) {
    ASSERT_FALSE(status);
    EXPECT_EQ(status.error().code, code);
    EXPECT_NE(status.error().message.find(says), std::string::npos) << status.error().message;
  }
};

using Registers = std::vector<std::uint16_t>;

Result<Registers> read(TestFarEnds& bench, std::uint16_t address, std::size_t count) {
  Registers registers(count);
  if (Status s = bench.ends.thermostat->read_registers(address, registers); !s) return s.error();
  return registers;
}

Status write(TestFarEnds& bench, std::uint16_t address, Registers values) {
  return bench.ends.thermostat->write_registers(address, values);
}

double as_float(const Registers& r, std::size_t at) {
  return static_cast<double>(
      std::bit_cast<float>(static_cast<std::uint32_t>(r[at]) << 16U | r[at + 1]));
}

TEST_F(ModbusFarEndTest, ShowsTemperaturesInTheTypesAndOrdersOfTheDescription) {
  TestFarEnds bench;
  bench.run_for(10.0);
  const auto registers = read(bench, 0x100, 7);
  ASSERT_TRUE(registers);
  EXPECT_NEAR(as_float(*registers, 0), 21.0, 0.05);
  EXPECT_NEAR(as_float(*registers, 2), 21.0, 0.05);
  const auto control = static_cast<std::int32_t>(
      static_cast<std::uint32_t>((*registers)[4]) << 16U | (*registers)[5]);
  EXPECT_NEAR(control * 0.001, 21.0, 0.05);
  EXPECT_NEAR((*registers)[6] * 0.01, 21.0, 0.05);
}

TEST_F(ModbusFarEndTest, HeatsWhatItIsToldTo) {
  TestFarEnds bench;
  ASSERT_TRUE(write(bench, 2, {310}));
  ASSERT_TRUE(write(bench, 273, {1}));
  EXPECT_EQ((*read(bench, 2, 1))[0], 310);
  EXPECT_EQ((*read(bench, 5, 1))[0], 310);
  EXPECT_EQ((*read(bench, 273, 1))[0], 1);
  bench.run_for(60.0);
  EXPECT_EQ((*read(bench, 85, 2)), (Registers{1200, 0}));
  bench.run_for(3600.0);
  EXPECT_NEAR(as_float(*read(bench, 0x100, 2), 0), 31.0, 0.05);
  EXPECT_EQ((*read(bench, 85, 1))[0], 0);
  ASSERT_TRUE(write(bench, 273, {0}));
  bench.run_for(1.0);
  EXPECT_EQ((*read(bench, 85, 2)), (Registers{0, 0}));
}

TEST_F(ModbusFarEndTest, ATransactionTakesItsTime) {
  TestFarEnds bench;
  ASSERT_TRUE(read(bench, 2, 1));
  EXPECT_EQ(bench.clock.now().time_since_epoch(), std::chrono::milliseconds(20));
}

TEST_F(ModbusFarEndTest, AnswersWithExceptionsWhatIsNoRegister) {
  TestFarEnds bench;
  Registers one(1);
  auto& thermostat = *bench.ends.thermostat;
  expect(thermostat.read_registers(1, one), ErrorCode::kDevice, "exception 2");
  expect(thermostat.read_registers(0x100, one), ErrorCode::kDevice,
         "exception 2");  // Half a float.
  expect(thermostat.read_registers(0x101, one), ErrorCode::kDevice, "exception 2");
  expect(thermostat.read_registers(2, {}), ErrorCode::kDevice, "exception 3");
  expect(write(bench, 5, {310}), ErrorCode::kDevice, "exception 2");  // Read only.
  expect(write(bench, 2, {900}), ErrorCode::kDevice, "exception 3");  // Above 70 degC.
  expect(write(bench, 273, {9}), ErrorCode::kDevice, "exception 3");  // No such mode.
  expect(write(bench, 1000, {9}), ErrorCode::kDevice, "exception 2");
  EXPECT_EQ((*read(bench, 273, 1))[0], 0);
}

TEST_F(ModbusFarEndTest, OtherRegistersAreMemory) {
  TestFarEnds bench;
  EXPECT_EQ((*read(bench, 300, 1))[0], 0);
  ASSERT_TRUE(write(bench, 300, {4711}));
  EXPECT_EQ((*read(bench, 300, 1))[0], 4711);
}

TEST_F(ModbusFarEndTest, TakesEvenCountsOnlyWhereTheInstrumentDoes) {
  config::BenchConfig config = test_bench();
  config.thermostat.device.even_counts_only = true;
  TestFarEnds bench(config);
  EXPECT_TRUE(read(bench, 0x100, 2));
  const auto odd = read(bench, 2, 1);
  ASSERT_FALSE(odd);
  expect(odd.error(), ErrorCode::kDevice, "exception 3");
}

TEST_F(ModbusFarEndTest, HonoursTheWordOrder) {
  config::BenchConfig config = test_bench();
  config.thermostat.device.registers[0].word_order = config::WordOrder::kLowFirst;
  TestFarEnds bench(config);
  bench.run_for(1.0);
  const Registers r = *read(bench, 0x100, 2);
  EXPECT_NEAR(as_float({r[1], r[0]}, 0), 21.0, 0.05);
}

TEST_F(ModbusFarEndTest, FailsInTheWaysOfTheScenario) {
  using config::FaultKind;
  const auto during = [](FaultKind kind) {
    config::ScenarioConfig scenario;
    scenario.faults = {fault("thermostat", kind, 10.0, 10.0)};
    return scenario;
  };
  const std::pair<FaultKind, ErrorCode> errors[] = {
      {FaultKind::kTimeout, ErrorCode::kTimeout},
      {FaultKind::kLateAnswer, ErrorCode::kTimeout},
      {FaultKind::kSilentExecution, ErrorCode::kTimeout},
      {FaultKind::kBadChecksum, ErrorCode::kProtocol},
      {FaultKind::kException, ErrorCode::kDevice},
      {FaultKind::kUnplug, ErrorCode::kUnplugged}};
  for (const auto& [kind, code] : errors) {
    TestFarEnds bench(test_bench(), during(kind));
    EXPECT_TRUE(read(bench, 2, 1));
    bench.run_for(11.0);
    const Status written = write(bench, 2, {310});
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().code, code);
    bench.run_for(10.0);
    const auto after = read(bench, 2, 1);
    ASSERT_TRUE(after);
    const bool executed = kind == FaultKind::kLateAnswer || kind == FaultKind::kSilentExecution ||
                          kind == FaultKind::kBadChecksum;
    EXPECT_EQ((*after)[0], executed ? 310 : 210) << static_cast<int>(kind);
  }
}

TEST_F(ModbusFarEndTest, SensorsBreakAndStickAndTheLineTalksNonsense) {
  using config::FaultKind;
  config::ScenarioConfig scenario;
  scenario.faults = {fault("thermostat", FaultKind::kNan, 10.0, 10.0),
                     fault("thermostat", FaultKind::kStuck, 30.0, 400.0),
                     fault("thermostat", FaultKind::kGarbage, 500.0, 10.0),
                     fault("thermostat", FaultKind::kSlowAnswer, 600.0, 10.0)};
  TestFarEnds bench(test_bench(), scenario);
  ASSERT_TRUE(write(bench, 2, {500}));
  ASSERT_TRUE(write(bench, 273, {1}));
  bench.run_for(11.0);
  EXPECT_EQ(*read(bench, 0x100, 7), (Registers{0x7FC0, 0, 0x7FC0, 0, 0x8000, 0, 0x8000}));
  bench.run_for(15.0);
  const Registers before = *read(bench, 0x100, 6);
  bench.run_for(200.0);
  EXPECT_EQ(*read(bench, 0x100, 6), before);
  bench.run_for(250.0);
  EXPECT_GT(as_float(*read(bench, 0x100, 2), 0), as_float(before, 0) + 1.0);
  bench.run_for(30.0);
  EXPECT_NE(*read(bench, 273, 1), (Registers{1}));
  bench.run_for(100.0);
  const auto start = bench.clock.now();
  EXPECT_TRUE(read(bench, 2, 1));
  EXPECT_EQ(bench.clock.now() - start, std::chrono::milliseconds(400));
}

}  // namespace
}  // namespace fogbench::simulator
