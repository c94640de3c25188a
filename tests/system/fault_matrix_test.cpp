// Every operation of every instrument crossed with every fault that it can have, through the real
// drivers and the run engine: what is recorded, what is void, how and in which time the run ends.
// The table says what should happen; why, stands in drivers/README.md and procedures/README.md.
//
//   .  the run goes on as if nothing had been; nothing is on record
//   w  readings are missing for a while, which is warned of; no point is void
//   v  a point is void and measured again
//   r  an instrument was unplugged: coils to 0 A, and when it is back the step begins anew, or the
//      sweep that it belongs to
//   E  the run ends, the bench is in its safe state, the record names the instrument
//   U  the run ends, and the record says of which instrument the safe state is not confirmed
//   X  the bench is not opened, the message names the instrument; nothing was commanded
//   -  the instrument cannot have this fault, or the operation no effect of it
//
// Whatever happens: no point on record is wrong, and a run that goes on has all of them.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <sstream>

#include "config/device_file.hpp"
#include "tests/support/source_tree.hpp"
#include "tests/system/fault_matrix.hpp"

namespace fogbench::system_test {
namespace {

using config::FaultKind;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// In the n-th operation of that name, and so many after it; or from a time on.
struct When {
  std::uint32_t at_operation = 0;
  std::uint32_t operations = 1;
  double at_s = 0.0;
  double for_s = 0.0;
};
constexpr When once(std::uint32_t at_operation, std::uint32_t operations = 1) {
  return {at_operation, operations, 0.0, 0.0};
}
constexpr When spell(double at_s, double for_s) {
  return {0, 1, at_s, for_s};
}
/// Within the first sweep, at 60 uT.
constexpr When kForGood = spell(60.0, 1e6);
constexpr When kFromTheStart = spell(0.0, 1e6);

/// How long a run waits for a cable to be found, on the ready bench.
constexpr double kLongestAbsenceS = 120.0;

struct Row {
  const char* device;
  const char* operation;
  When when;
  const char* outcomes;
  /// Bench time from the fault's beginning to the end of the safe state, where the run ends.
  double within_s = 45.0;
};

constexpr std::array<const char*, 11> kKinds = {
    "timeout", "late_answer", "silent_execution", "bad_checksum", "bad_sequence", "garbage",
    "nan",     "stuck",       "exception",        "unplug",       "slow_answer"};

// clang-format off
//                                                  silent execution
//                                                  | checksum
//                                                  | | sequence
//                                          timeout | | | garbage
//                                                | | | | | nan
//                                                |late | | | stuck
//                                                | | | | | | | | exception
//                                                | | | | | | | | | unplug
//                                                | | | | | | | | | | slow
const Row kTable[] = {
  // Lost on the way: asked again. Refused or nonsense: that second's readings are missing.
  {"thermostat", "read", once(200),              ". . . . . w w . w . ."},
  // Slow answers make a reading of six requests older than it may be.
  {"thermostat", "read", spell(6.0, 16.0),       "v v v v v v v v v v v"},
  // Switching off asks for no temperature, only for the heating mode.
  {"thermostat", "read", kForGood,               "U U U U U U E E U U E", 60.0},
  {"thermostat", "set_target", once(1),          ". . . . . . . . E . ."},
  {"thermostat", "set_target", kFromTheStart,    "E . . . . . . . E E ."},
  {"thermostat", "set_mode", once(1),            ". . . . . . . . E . ."},
  {"thermostat", "set_mode", kForGood,           "U . . . . . . . U U .", 150.0},

  {"coil", "clear", once(1),                     "X . . - . . . . . X ."},
  {"coil", "identify", once(1),                  ". . . - . X . . . X ."},
  {"coil", "initialise", once(2),                "X . . - . . . . X X ."},
  // Lost: sent again after a look at the setting. There is none for the switch.
  {"coil", "set", once(4),                       ". . . - . . . . E r ."},
  // No zero gets through, but the output goes off, and that is 0 A read back too.
  {"coil", "set", kForGood,                      "E . . - . . . . U E ."},
  {"coil", "output_on", once(1),                 "E . . - . . . . E r ."},
  {"coil", "output_off", once(1),                "X . . - . . . . X X ."},
  {"coil", "output_off", once(2),                ". . . - . . . . . . ."},
  // 0 A is read back all the same; a refusal is told.
  {"coil", "output_off", kForGood,               ". . . - . . . . U . .", 150.0},
  {"coil", "set_query", once(10),                ". . . - . . . . . w ."},
  {"coil", "set_query", kForGood,                "E E E - E E E . E E ."},
  {"coil", "measure", once(10),                  ". . . - . . . . . w ."},
  // At 0 A all the while: a read-back that stands still is a right one.
  {"coil", "measure", spell(6.0, 16.0),          "v v v - v v v . v v ."},
  {"coil", "measure", kForGood,                  "U U U - U U U U U U ."},
  {"coil", "error_query", once(10),              ". . . - . . . . . r ."},
  // What is set is read back, so the run goes on.
  {"coil", "error_query", kForGood,              ". . . - . . . . . E .", 300.0},

  {"turntable", "clear", once(1),                "X . . - . . . . . X ."},
  {"turntable", "identify", once(1),             ". . . - . X . . . X ."},
  {"turntable", "initialise", once(1),           "X . . - . . . . . X ."},
  {"turntable", "set", once(1),                  ". . . - . . . . E r ."},
  {"turntable", "set", kFromTheStart,            "E . . - . . . . E E ."},
  {"turntable", "measure", once(1),              ". . . - . . . . . . ."},
  {"turntable", "measure", once(5),              ". . . - . . . . . r ."},
  // Stuck: it has three times the usual 20 s to get there.
  {"turntable", "measure", kForGood,             "E E E - E E E E E E .", 100.0},
  {"turntable", "error_query", kForGood,         ". . . - . . . . . E ."},

  {"magnetometer", "report", once(20),           "w w - - w w w . w w ."},
  {"magnetometer", "report", spell(6.0, 16.0),   "v v - - w v v v v v ."},
  {"magnetometer", "report", kForGood,           "E E - - w E E E E E ."},

  // A frame more or less is counted as dropped; 0.3 s of them are a gap.
  {"gyro", "frame", once(1000),                  ". . - . . . . . . . ."},
  {"gyro", "frame", once(1000, 30),              "v . - v v v v v v v ."},
  // Late ones have lost nothing when they come.
  {"gyro", "frame", spell(62.0, 3.0),            "v w - v v v v v v r ."},
  {"gyro", "frame", kForGood,                    "E E - E E E E E E E ."},
};
// clang-format on

struct Case {
  std::string device;
  const Row* row;
};

/// Both supplies are the same make.
std::vector<Case> cases() {
  std::vector<Case> all;
  for (const Row& row : kTable) {
    if (std::string_view(row.device) != "coil") {
      all.push_back({row.device, &row});
    } else {
      all.push_back({"coil_horizontal", &row});
      all.push_back({"coil_vertical", &row});
    }
  }
  return all;
}

config::FaultSpec fault(const Case& c, FaultKind kind) {
  const When& when = c.row->when;
  config::FaultSpec spec{c.device, kind, config::Seconds{when.at_s}, config::Seconds{when.for_s}};
  if (when.at_operation > 0) spec.at_operation = when.at_operation;
  spec.operations = when.operations;
  spec.operation = c.row->operation;
  return spec;
}

char outcome(const Trial& trial) {
  if (!trial.opened) return 'X';
  const procedures::RunEnd& end = trial.summary.end;
  if (end.outcome != procedures::RunOutcome::kCompleted) return end.safe_state_reached ? 'E' : 'U';
  if (trial.log.has_event("coils to 0 A until it is back")) return 'r';
  if (trial.log.has_event("point voided")) return 'v';
  return trial.log.has_event("readings are missing") ? 'w' : '.';
}

/// What has been said about the fault, for a test that fails.
std::string story(const Trial& trial) {
  std::string all = trial.open_error + trial.summary.end.reason;
  for (const auto& event : trial.log.events) {
    all += fmt::format("\n  {:.1f} s: {}", event.time_s, event.message);
  }
  return all;
}

const Trial& undisturbed() {
  static const Trial trial = run_with(std::nullopt);
  return trial;
}

void expect_recorded(const Trial& trial, const std::string& device) {
  const std::string& reason = trial.summary.end.reason;
  switch (outcome(trial)) {
    case 'X':
      EXPECT_THAT(trial.open_error, StartsWith(device + ": "));
      return;
    case 'E':
      EXPECT_THAT(reason, HasSubstr(device + ": "));
      return;
    case 'U':
      EXPECT_THAT(reason, HasSubstr("the safe state is not confirmed for " + device + " "));
      return;
    case 'w':
      EXPECT_TRUE(trial.log.has_event(device + ": answers again after"));
      break;
    default:
      break;
  }
  EXPECT_FALSE(trial.log.has_event(device + ": " + device)) << "said once";
  EXPECT_EQ(trial.log.points.size(), undisturbed().log.points.size());
}

class FaultMatrix : public testing::TestWithParam<Case> {};

TEST_P(FaultMatrix, EndsAsItShould) {
  const Case& c = GetParam();
  std::istringstream outcomes(c.row->outcomes);
  for (std::size_t kind = 0; kind < kKinds.size(); ++kind) {
    std::string expected;
    ASSERT_TRUE(outcomes >> expected);
    if (expected == "-") continue;
    const Trial trial = run_with(fault(c, static_cast<FaultKind>(kind)));
    SCOPED_TRACE(std::string(kKinds[kind]) + ": " + story(trial));
    EXPECT_EQ(std::string(1, outcome(trial)), expected) << c.device << " " << c.row->operation;
    EXPECT_EQ(wrong_point(trial), "");
    expect_recorded(trial, c.device);
    const bool ended = outcome(trial) == 'E' || outcome(trial) == 'U';
    const double begun_s = c.row->when.at_s;
    const double since_s = ended && begun_s > 0.0 ? begun_s : undisturbed().ended_s;
    const bool unplugged = static_cast<FaultKind>(kind) == FaultKind::kUnplug;
    const double absence_s = ended && unplugged ? kLongestAbsenceS : 0.0;
    EXPECT_LE(trial.ended_s, since_s + c.row->within_s + absence_s);
  }
}

std::string name_of(const testing::TestParamInfo<Case>& tried) {
  return fmt::format("{}_{}_{}", tried.param.device, tried.param.row->operation, tried.index);
}
INSTANTIATE_TEST_SUITE_P(All, FaultMatrix, testing::ValuesIn(cases()), name_of);

TEST(FaultMatrixBench, WithoutAFaultEveryPointIsThereAndRight) {
  EXPECT_EQ(outcome(undisturbed()), '.') << story(undisturbed());
  EXPECT_EQ(undisturbed().log.points.size(), 7U);
  EXPECT_EQ(wrong_point(undisturbed()), "");
}

/// The bench with one ready device in the place of its own.
config::BenchConfig bench_with(const std::string& name) {
  config::BenchConfig bench = quiet_bench();
  const auto file = config::load_device(tests::source_tree() / "config/devices" / name);
  EXPECT_TRUE(file) << file.error().message;
  if (const auto* modbus = std::get_if<config::ModbusDevice>(&*file)) {
    bench.thermostat.device = *modbus;
  } else if (const auto* hid = std::get_if<config::HidDevice>(&*file)) {
    const config::HidDevice own = bench.magnetometer.device;
    bench.magnetometer.device = *hid;
    bench.magnetometer.device.calibration_offset_ut = own.calibration_offset_ut;
    bench.magnetometer.device.calibration_matrix = own.calibration_matrix;
  } else if (const auto* frame = std::get_if<config::FrameDevice>(&*file)) {
    bench.gyro.device = *frame;
  } else if (const auto* scpi = std::get_if<config::ScpiDevice>(&*file)) {
    const bool supplies = scpi->unit == "A";
    if (supplies) bench.coil_horizontal.device = bench.coil_vertical.device = *scpi;
    if (!supplies) bench.turntable.device = *scpi;
  } else {
    const auto add = [&]<class Device>(const Device& device) {
      if constexpr (std::is_constructible_v<config::SensorDevice, Device>) {
        bench.auxiliary.emplace_back();
        bench.auxiliary.back().name = "sensor";
        bench.auxiliary.back().device = device;
      }
    };
    std::visit(add, *file);
  }
  return bench;
}

TEST(FaultMatrixBench, EveryReadyDeviceGoesThroughARun) {
  std::size_t tried = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(tests::source_tree() / "config/devices")) {
    const std::string name = entry.path().filename().string();
    const Trial trial = run_with(std::nullopt, bench_with(name));
    EXPECT_EQ(outcome(trial), '.') << name << ": " << story(trial);
    EXPECT_EQ(wrong_point(trial), "") << name;
    EXPECT_EQ(trial.log.points.size(), 7U) << name;
    ++tried;
  }
  EXPECT_GE(tried, 12U);
}

}  // namespace
}  // namespace fogbench::system_test
