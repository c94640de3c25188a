// The coil supplies and the turntable at their messages.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>

#include "tests/simulator/test_bench.hpp"

namespace fogbench::simulator {
namespace {

using config::FaultKind;
using namespace std::chrono_literals;

std::string ask(drivers::MessageTransport& line, std::string_view question) {
  if (Status s = line.write(question); !s) return s.error().message;
  Result<std::string> answer = line.read(1s);
  return answer ? *answer : answer.error().message;
}

double ask_number(drivers::MessageTransport& line, std::string_view question) {
  return std::stod(ask(line, question));
}

/// The vertical coil's field, as the magnetometer says (gyro's Y at azimuth 0).
double field_y(TestFarEnds& bench) {
  std::uint8_t report[16];
  EXPECT_TRUE(bench.ends.magnetometer->read_report(report, 1s));
  std::int32_t raw = 0;
  std::memcpy(&raw, report + 5, sizeof raw);
  return raw * 1e-4;
}

TEST(ScpiFarEnd, IdentifiesItselfAndHasNothingToComplainOf) {
  TestFarEnds bench;
  EXPECT_EQ(ask(*bench.ends.coil_vertical, "*IDN?"), "KEPCO,BOP 36-6");
  EXPECT_EQ(ask(*bench.ends.turntable, "*IDN?"), "TURNTABLE");
  for (const char* command : {"*CLS", "FUNC:MODE CURR", "volt 30", "*RST"}) {
    EXPECT_TRUE(bench.ends.coil_vertical->write(command));
  }
  EXPECT_EQ(ask(*bench.ends.coil_vertical, "SYST:ERR?"), "0,\"No error\"");
}

TEST(ScpiFarEnd, CurrentMakesTheFieldOnceTheOutputIsOn) {
  TestFarEnds bench;
  auto& supply = *bench.ends.coil_vertical;
  const double ambient = field_y(bench);
  ASSERT_TRUE(supply.write("CURR 1.5"));
  bench.run_for(1.0);
  EXPECT_NEAR(field_y(bench), ambient, 0.02);
  ASSERT_TRUE(supply.write("OUTP ON"));
  bench.run_for(1.0);
  EXPECT_NEAR(field_y(bench), ambient + 1.5 * 89.9 * std::cos(0.3 * M_PI / 180.0), 0.03);
  EXPECT_DOUBLE_EQ(ask_number(supply, "CURR?"), 1.5);
  EXPECT_NEAR(ask_number(supply, "MEAS:CURR?"), 1.5, 1e-3);
  ASSERT_TRUE(supply.write("OUTP OFF"));
  bench.run_for(1.0);
  EXPECT_EQ(ask_number(supply, "CURR?"), 0.0);
  EXPECT_NEAR(ask_number(supply, "MEAS:CURR?"), 0.0, 1e-3);
  EXPECT_NEAR(field_y(bench), ambient, 0.02);
}

TEST(ScpiFarEnd, ReadBackIsAMeanThatIsValidOnceSettled) {
  TestFarEnds bench;
  auto& supply = *bench.ends.coil_vertical;
  ASSERT_TRUE(supply.write("OUTP ON"));
  ASSERT_TRUE(supply.write("CURR -2"));
  bench.run_for(0.155);
  EXPECT_NEAR(ask_number(supply, "MEAS:CURR?"), -1.0, 0.01);  // Half of 320 ms, with the message.
  bench.run_for(0.32);
  EXPECT_NEAR(ask_number(supply, "MEAS:CURR?"), -2.0, 1e-3);
}

TEST(ScpiFarEnd, OutputAndReadBackHaveFifteenBitsAndASign) {
  TestFarEnds bench;
  auto& supply = *bench.ends.coil_vertical;
  ASSERT_TRUE(supply.write("OUTP ON;CURR 1.00005"));
  bench.run_for(1.0);
  const double counts = ask_number(supply, "MEAS:CURR?") / (4.0 / 32768.0);
  EXPECT_NEAR(counts, std::round(counts), 0.01);
  EXPECT_NEAR(counts, 8192.0, 5.0);
}

TEST(ScpiFarEnd, QueuesAnErrorForWhatItCannotDoAndDoesNothing) {
  TestFarEnds bench;
  auto& supply = *bench.ends.coil_vertical;
  ASSERT_TRUE(supply.write("CURR 0.5"));
  for (const char* command : {"CURR 4.1", "CURR -1e9", "CURR nan", "CURR", "CURR one", "CURR 1 2",
                              "CURT 1", "*TST?", "FUNC:MODE VOLT"}) {
    ASSERT_TRUE(supply.write(command)) << command;
  }
  EXPECT_EQ(ask(supply, "SYST:ERR?"), "-222,\"Data out of range\"");
  EXPECT_EQ(ask(supply, "SYST:ERR?"), "-222,\"Data out of range\"");
  EXPECT_EQ(ask(supply, "SYST:ERR?"), "-222,\"Data out of range\"");
  EXPECT_EQ(ask(supply, "SYST:ERR?"), "-109,\"Missing parameter\"");
  EXPECT_EQ(ask(supply, "SYST:ERR?"), "-120,\"Numeric data error\"");
  EXPECT_EQ(ask(supply, "SYST:ERR?"), "-120,\"Numeric data error\"");
  EXPECT_EQ(ask(supply, "SYST:ERR?"), "-113,\"Undefined header\"");
  EXPECT_EQ(ask(supply, "SYST:ERR?"), "-113,\"Undefined header\"");
  EXPECT_EQ(ask(supply, "SYST:ERR?"), "-113,\"Undefined header\"");
  EXPECT_EQ(ask(supply, "SYST:ERR?"), "0,\"No error\"");
  EXPECT_DOUBLE_EQ(ask_number(supply, "CURR?"), 0.5);
}

TEST(ScpiFarEnd, SaysThatItsErrorQueueRanOver) {
  TestFarEnds bench;
  auto& supply = *bench.ends.coil_vertical;
  for (int i = 0; i < 30; ++i) ASSERT_TRUE(supply.write("NONSENSE"));
  for (int i = 0; i < 19; ++i) EXPECT_EQ(ask(supply, "SYST:ERR?"), "-113,\"Undefined header\"");
  EXPECT_EQ(ask(supply, "SYST:ERR?"), "-350,\"Queue overflow\"");
  EXPECT_EQ(ask(supply, "SYST:ERR?"), "0,\"No error\"");
  ASSERT_TRUE(supply.write("NONSENSE"));
  ASSERT_TRUE(supply.write("*CLS"));
  EXPECT_EQ(ask(supply, "SYST:ERR?"), "0,\"No error\"");
}

TEST(ScpiFarEnd, ComplainsOfQueriesThatAreNotReadAndReadsWithoutQuery) {
  TestFarEnds bench;
  auto& supply = *bench.ends.coil_vertical;
  const auto before = bench.clock.now();
  const auto nothing = supply.read(200ms);
  ASSERT_FALSE(nothing);
  EXPECT_EQ(nothing.error().code, ErrorCode::kTimeout);
  EXPECT_EQ(bench.clock.now() - before, 200ms);
  EXPECT_EQ(ask(supply, "SYST:ERR?"), "-420,\"Query UNTERMINATED\"");
  ASSERT_TRUE(supply.write("CURR?"));
  ASSERT_TRUE(supply.write("CURR?"));
  ASSERT_TRUE(supply.clear());
  EXPECT_EQ(ask(supply, "SYST:ERR?"), "-410,\"Query INTERRUPTED\"");
}

TEST(ScpiFarEnd, TheTurntableMovesAtItsSpeedAndTakesTheGyroAlong) {
  TestFarEnds bench;
  auto& table = *bench.ends.turntable;
  const double north = field_y(bench);
  ASSERT_TRUE(table.write("POS 90"));
  EXPECT_DOUBLE_EQ(ask_number(table, "POS?"), 90.0);
  bench.run_for(10.0);
  EXPECT_NEAR(ask_number(table, "MEAS:POS?"), 45.0, 1.0);
  bench.run_for(10.5);
  EXPECT_DOUBLE_EQ(ask_number(table, "MEAS:POS?"), 90.0);
  EXPECT_NEAR(north, 16.0, 0.1);
  EXPECT_NEAR(field_y(bench), 1.0, 0.1);
  ASSERT_TRUE(table.write("POS 361"));
  EXPECT_EQ(ask(table, "SYST:ERR?"), "-222,\"Data out of range\"");
}

TEST(ScpiFarEnd, DrivesNoCurrentThroughAnOpenCircuitWhateverIsSet) {
  config::ScenarioConfig scenario;
  scenario.faults = {fault("coil_vertical", FaultKind::kOpenCircuit, 10.0, 10.0)};
  TestFarEnds bench(test_bench(), scenario);
  auto& supply = *bench.ends.coil_vertical;
  const double ambient = field_y(bench);
  ASSERT_TRUE(supply.write("CURR 1.5"));
  ASSERT_TRUE(supply.write("OUTP ON"));
  bench.run_for(11.0);
  EXPECT_DOUBLE_EQ(ask_number(supply, "CURR?"), 1.5);
  bench.run_for(1.0);
  EXPECT_NEAR(ask_number(supply, "MEAS:CURR?"), 0.0, 1e-3);
  EXPECT_NEAR(field_y(bench), ambient, 0.02);
  bench.run_for(10.0);
  ask(supply, "CURR?");
  bench.run_for(1.0);
  EXPECT_NEAR(ask_number(supply, "MEAS:CURR?"), 1.5, 1e-3);
}

TEST(ScpiFarEnd, FailsInTheWaysOfTheScenario) {
  const auto during = [](FaultKind kind) {
    config::ScenarioConfig scenario;
    scenario.faults = {fault("coil_vertical", kind, 10.0, 10.0)};
    return scenario;
  };
  struct Case {
    FaultKind kind;
    std::string answer;  ///< to CURR? after CURR 1
    double current_a;    ///< when it is over
  };
  const Case cases[] = {
      {FaultKind::kTimeout, "no answer", 0.0},    {FaultKind::kUnplug, "unplugged", 0.0},
      {FaultKind::kLateAnswer, "no answer", 1.0}, {FaultKind::kSilentExecution, "no answer", 1.0},
      {FaultKind::kException, "no answer", 0.0},
  };
  for (const Case& c : cases) {
    TestFarEnds bench(test_bench(), during(c.kind));
    auto& supply = *bench.ends.coil_vertical;
    bench.run_for(11.0);
    (void)supply.write("CURR 1");
    EXPECT_EQ(ask(supply, "CURR?"), c.answer);
    bench.run_for(10.0);
    EXPECT_EQ(ask_number(supply, "CURR?"), c.current_a) << static_cast<int>(c.kind);
  }
  TestFarEnds bench(test_bench(), during(FaultKind::kException));
  bench.run_for(11.0);
  ASSERT_TRUE(bench.ends.coil_vertical->write("CURR 1"));
  EXPECT_EQ(ask(*bench.ends.coil_vertical, "SYST:ERR?"), "-200,\"Execution error\"");
}

TEST(ScpiFarEnd, ReadsBackNonsenseWhenTheScenarioSaysSo) {
  config::ScenarioConfig scenario;
  scenario.faults = {fault("coil_vertical", FaultKind::kNan, 10.0, 10.0),
                     fault("coil_vertical", FaultKind::kStuck, 30.0, 10.0),
                     fault("coil_vertical", FaultKind::kGarbage, 50.0, 10.0)};
  TestFarEnds bench(test_bench(), scenario);
  auto& supply = *bench.ends.coil_vertical;
  ASSERT_TRUE(supply.write("OUTP ON"));
  bench.run_for(11.0);
  EXPECT_EQ(ask(supply, "MEAS:CURR?"), "9.91E37");
  bench.run_for(20.0);
  const std::string before = ask(supply, "MEAS:CURR?");
  ASSERT_TRUE(supply.write("CURR 1"));
  bench.run_for(2.0);
  EXPECT_EQ(ask(supply, "MEAS:CURR?"), before);
  bench.run_for(10.0);
  EXPECT_NEAR(ask_number(supply, "MEAS:CURR?"), 1.0, 1e-3);
  bench.run_for(8.0);
  EXPECT_NE(ask(supply, "*IDN?"), "KEPCO,BOP 36-6");
}

}  // namespace
}  // namespace fogbench::simulator
