// The safety matrix: every fault of every instrument, and every pair of faults of two instruments,
// in every situation. Before each cell the coils carry current and the heaters heat; after it, the
// plant is asked. Whoever can be reached is off, and says so; of whoever cannot, the report says
// which it is, and nothing false in either direction.
//
// One triangle is printed for each situation: a row and a column for each fault, the diagonal for
// one alone.
//
//   .  the run was completed; every actuator is off, read back
//   e  the run ended early, or the start was refused; every actuator is off, read back
//   c  of at least one actuator: commanded, not confirmed; the others are off, read back
//   u  of at least one: unreachable; the others are off, read back
//   b  both
//   X  something else, which fails the test

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "drivers/safe_state.hpp"
#include "procedures/expand.hpp"
#include "procedures/run_engine.hpp"
#include "tests/procedures/procedure_builder.hpp"
#include "tests/support/memory_recorder.hpp"
#include "tests/support/source_tree.hpp"
#include "tests/system/enduring_bench.hpp"

namespace fogbench::system_test {
namespace {

using namespace std::chrono_literals;
using config::HeatingMode;
using procedures::test::step;
using State = drivers::Safety::State;
using Instant = drivers::Clock::Instant;

/// All are told before any is waited for; a supply that hears nothing takes 0.5 s for each of its
/// two messages, and a thermostat for its one.
constexpr drivers::Clock::Duration kTold = 2s;
/// Three rounds, in each of them two supplies that hear nothing (two messages and a question, 0.5 s
/// each, and the clearing after it) and a thermostat that hears nothing (one message and three
/// questions of 0.5 s): 3 * (2 * 2 s + 2 s), and a second for settling.
constexpr drivers::Clock::Duration kSafeState = 19s;
/// From the fault to the end of the safe state. The longest that a run waits is for a turntable
/// that does not come: three times its 20 s; readings may be missing for 30 s, and an instrument
/// for this bench's 20 s.
constexpr drivers::Clock::Duration kBound = 60s + kSafeState;
constexpr config::Seconds kAbsence{20.0};

/// What is no current: a hundredth of what the supply can read back.
constexpr double kNoCurrentA = 5e-5;

constexpr const char* kActuators[] = {"coil_horizontal", "coil_vertical", "thermostat"};

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define FOGBENCH_SANITIZED
#endif
#endif
#ifdef FOGBENCH_SANITIZED
constexpr std::size_t kEvery = 23;  // of the pairs: a sanitizer takes forty times as long
#else
constexpr std::size_t kEvery = 1;
#endif

const config::BenchConfig& safety_bench() {
  static const config::BenchConfig made = [] {
    auto bench = config::load_bench(tests::source_tree() / "config/benches/simulated.json");
    EXPECT_TRUE(bench) << bench.error().message;
    bench->simulation.magnetic.ambient_steps_per_h = 0.0;
    bench->limits.absence_maximum = kAbsence;
    // A slow gyro: nothing here is measured with it.
    bench->gyro.device.frame_rate_hz = 20.0;
    bench->gyro.device.stuck_after = config::Seconds{1.0};
    bench->gyro.max_gap = config::Seconds{0.5};
    return *bench;
  }();
  return made;
}

procedures::Plan plan_of(std::vector<config::Step> steps) {
  const auto no_calls = [](const std::string& name, const config::ProcedureConfig&) {
    return Result<config::ProcedureConfig>(Error{ErrorCode::kBadInput, name});
  };
  const auto expanded =
      procedures::expand(procedures::test::procedure("safety", std::move(steps)), {}, no_calls);
  EXPECT_TRUE(expanded) << expanded.error().message;
  auto plan = procedures::make_plan("safety", *expanded, safety_bench());
  EXPECT_TRUE(plan) << plan.error().message;
  return *std::move(plan);
}

/// The heaters boost and both coils carry more than an ampere.
std::vector<config::Step> energised_and(const std::vector<config::Step>& last) {
  std::vector<config::Step> all = {
      step(config::SetTemperature{50.0, HeatingMode::kBoost}), step(config::CompensateField{0.5}),
      step(config::Sweep{config::Axis::kX, std::vector{200.0}, 1.0, 0.5, "x", -200.0})};
  all.insert(all.end(), last.begin(), last.end());
  return all;
}
constexpr int kEnergisingSteps = 3;

struct Situation {
  const char* name;
  /// Nothing: a start, or the next run of an idle bench.
  std::vector<config::Step> last = {};
  drivers::Clock::Duration begins_after = 1300ms;  ///< the fault, in that step
  bool aborted = false;                            ///< two seconds later
};

const std::vector<Situation>& situations() {
  static const config::Sweep sweep{config::Axis::kX, std::vector{0.0, 200.0, 0.0}, 3.0, 1.0, "x"};
  static const std::vector<Situation> all = {
      {"start"},
      {"idle"},
      // Over within a few transactions; who is exchanged then is back before the end.
      {"set_temperature",
       {step(config::SetTemperature{40.0, HeatingMode::kNormal}), step(config::Wait{3.0})},
       10ms},
      {"ramp", {step(config::Ramp{21.3, 40.0}), step(config::Wait{3.0})}},
      {"settle_temperature", {step(config::SettleTemperature{40.0, 5.0, 1e6, 15.0})}},
      {"wait", {step(config::Wait{5.0})}},
      {"average", {step(config::Average{5.0, "a"})}},
      {"baseline", {step(config::Baseline{5.0, "b"})}},
      {"compensate_field", {step(config::CompensateField{0.2})}},
      {"sweep", {step(sweep)}},
      {"rotate", {step(config::Rotate{90.0}), step(config::Wait{3.0})}},
      {"prompt", {step(config::Prompt{"go on?"})}},
      {"abort_in_a_wait", {step(config::Wait{20.0})}, 1300ms, true},
      {"abort_in_a_sweep", {step(sweep)}, 1300ms, true}};
  return all;
}

/// Answers after a few seconds.
class SlowPerson final : public drivers::Operator {
 public:
  Result<bool> confirm(const std::string&) override {
    constexpr int kSeconds = 5;
    for (int i = 0; i < kSeconds; ++i) {
      if (const Status watched = engine->keep_watch(); !watched) return watched.error();
    }
    return true;
  }
  procedures::RunEngine* engine = nullptr;
};

/// One cell: what was said of each actuator, and how it came to that.
struct Cell {
  bool completed = false;
  std::map<std::string, State> said;
  std::string story;
  std::string wrong;  ///< found on the way; empty: nothing
  drivers::Clock::Duration took{};
};

void hear(Cell& cell, const drivers::SafetyReport& report) {
  for (const drivers::Safety& safety : report.actuators) cell.said[safety.actuator] = safety.state;
  cell.story += "\n  " + report.text();
}

/// From what a person reads.
void hear(Cell& cell, const std::string& text) {
  for (const std::string actuator : kActuators) {
    cell.said[actuator] =
        text.find(actuator + " unreachable") != std::string::npos     ? State::kUnreachable
        : text.find(actuator + " commanded off") != std::string::npos ? State::kCommanded
                                                                      : State::kReadBack;
  }
  cell.story += "\n  " + text;
}

const Fault* fault_of(std::string_view device, const std::vector<Fault>& faults) {
  const auto found = std::find_if(faults.begin(), faults.end(),
                                  [&](const Fault& fault) { return fault.device == device; });
  return found == faults.end() ? nullptr : &*found;
}

bool obeys(const Fault* fault) {
  return fault == nullptr ||
         (fault->ill != Ill::kAbsent && fault->ill != Ill::kSilent && fault->ill != Ill::kStuck);
}

/// What is to be said of an actuator that is in truth off or not.
State truth(std::string_view actuator, const Fault* fault, bool off) {
  if (fault == nullptr) return State::kReadBack;
  switch (fault->ill) {
    case Ill::kAbsent:
      return State::kUnreachable;
    case Ill::kSilent:
    case Ill::kGarbling:
    case Ill::kBadChecksum:
      return State::kCommanded;
    case Ill::kNoNumber:  // A supply measures its current, a thermostat other things.
      return actuator == "thermostat" ? State::kReadBack : State::kCommanded;
    case Ill::kStuck:  // One that happened to be off says so.
      return off ? State::kReadBack : State::kCommanded;
    default:
      return State::kReadBack;
  }
}

/// Holds what was said against the plant; what is wrong in sentences, empty when nothing is.
std::string judge(EnduringBench& bench, const std::vector<Fault>& faults, const Cell& cell) {
  std::string wrong = cell.wrong;
  bench.clock().sleep_for(500ms);  // The last current decays.
  for (const std::string actuator : kActuators) {
    const bool off = actuator == "thermostat" ? !bench.heats()
                                              : std::abs(bench.current_a(actuator)) < kNoCurrentA;
    const Fault* fault = fault_of(actuator, faults);
    if (obeys(fault) && !off) wrong += actuator + " is not off; ";
    const auto said = cell.said.find(actuator);
    if (said == cell.said.end()) {
      wrong += "nothing was said of " + actuator + "; ";
    } else if (said->second != truth(actuator, fault, off)) {
      wrong += fmt::format("{} is {}, and was said to be {}; ", actuator, off ? "off" : "on",
                           static_cast<int>(said->second));
    }
  }
  return wrong;
}

char letter(const Cell& cell, const std::string& wrong) {
  if (!wrong.empty()) return 'X';
  const auto any = [&](State state) {
    return std::any_of(cell.said.begin(), cell.said.end(),
                       [&](const auto& said) { return said.second == state; });
  };
  if (any(State::kCommanded)) return any(State::kUnreachable) ? 'b' : 'c';
  if (any(State::kUnreachable)) return 'u';
  return cell.completed ? '.' : 'e';
}

drivers::Bench attached(EnduringBench& bench, drivers::Operator& person) {
  auto made = drivers::attach_bench(safety_bench(), bench.transports(), bench.clock(), person);
  EXPECT_TRUE(made) << made.error().message;
  return *std::move(made);
}

/// The last daemon has died; this one finds the bench as it is.
Cell start(EnduringBench& bench, const std::vector<Fault>& faults) {
  Cell cell;
  SlowPerson nobody;
  bench.energise();
  for (const Fault& fault : faults) bench.begin(fault, false);
  bench.forget_what_was_heard();
  const Instant begun = bench.clock().now();
  const drivers::Bench session = attached(bench, nobody);
  hear(cell, drivers::make_safe(session));
  cell.took = bench.clock().now() - begun;
  if (cell.took > kSafeState) cell.wrong += "the safe state takes too long; ";
  for (const char* coil : {"coil_horizontal", "coil_vertical"}) {
    if (!obeys(fault_of(coil, faults))) continue;
    const Instant told = bench.heard(coil, "CURR 0.000000");
    const Instant asked = bench.heard(coil, "MEAS:CURR?");
    if (told > begun + kTold) cell.wrong += fmt::format("{} hears late; ", coil);
    if (asked < told || asked == Instant::max()) {
      cell.wrong += fmt::format("{} was not asked; ", coil);
    }
  }
  // As a daemon goes on: nothing that it does to begin may undo it.
  cell.wrong += judge(bench, faults, cell);
  cell.completed = static_cast<bool>(drivers::begin_bench(session));
  hear(cell, drivers::make_safe(session));
  return cell;
}

Cell run(EnduringBench& bench, const std::vector<Fault>& faults, const Situation& situation) {
  Cell cell;
  SlowPerson person;
  test::MemoryRecorder log;
  drivers::Bench session = attached(bench, person);
  EXPECT_TRUE(drivers::begin_bench(session));
  procedures::RunEngine engine(safety_bench(), session, bench.clock(), person, log);
  person.engine = &engine;
  Instant begun{};
  const auto fall_ill = [&] {
    begun = bench.clock().now();
    for (const Fault& fault : faults) bench.begin(fault, true);
    if (situation.aborted) bench.clock().in(2s, [&] { engine.request_abort(); });
  };
  int steps = 0;
  log.fails = [&](const std::string& what) {
    if (what == "step_started" && ++steps == kEnergisingSteps + 1 && !situation.last.empty()) {
      bench.clock().in(situation.begins_after, fall_ill);
    }
    return false;
  };
  if (situation.last.empty()) {
    bench.energise();  // Somebody at the front panels.
    fall_ill();
    bench.clock().sleep_for(2s);
  }
  const auto summary = engine.run(situation.last.empty() ? plan_of({step(config::Wait{5.0})})
                                                         : plan_of(energised_and(situation.last)),
                                  {});
  cell.took = bench.clock().now() - begun;
  if (begun == Instant{}) cell.wrong += "the step was never reached; ";
  if (cell.took > kBound) {
    cell.wrong += fmt::format("the end took {:.1f} s; ", drivers::to_seconds(cell.took));
  }
  cell.completed = summary && summary->end.outcome == procedures::RunOutcome::kCompleted;
  hear(cell, summary ? summary->end.reason : summary.error().message);
  if (summary) {
    const bool all = std::all_of(cell.said.begin(), cell.said.end(),
                                 [](const auto& said) { return said.second == State::kReadBack; });
    if (summary->end.safe_state_reached != all) cell.wrong += "reason and flag differ; ";
  }
  if (!engine.left_safe()) {
    // As a daemon goes on: who was being exchanged may be there now.
    bench.clock().sleep_for(2s);
    hear(cell, drivers::make_safe(session));
  }
  for (const auto& event : log.events) {
    cell.story += fmt::format("\n  {:.1f} s: {}", event.time_s, event.message);
  }
  return cell;
}

class SafetyMatrix : public testing::TestWithParam<std::size_t> {};

TEST_P(SafetyMatrix, WhoeverCanBeReachedIsOffAndOfTheOthersItIsSaid) {
  const Situation& situation = situations()[GetParam()];
  const std::vector<Fault>& all = all_faults();
  std::size_t cells = 0;
  drivers::Clock::Duration longest{};
  std::string slowest;
  const auto try_with = [&](const std::vector<Fault>& faults) {
    EnduringBench bench(safety_bench());
    Cell cell = std::string_view(situation.name) == "start" ? start(bench, faults)
                                                            : run(bench, faults, situation);
    const std::string wrong = judge(bench, faults, cell);
    std::string names;
    for (const Fault& fault : faults) names += (names.empty() ? "" : " and ") + name_of(fault);
    EXPECT_EQ(wrong, "") << situation.name << ", " << names << ":" << cell.story;
    if (cell.took > longest) {
      longest = cell.took;
      slowest = names;
    }
    ++cells;
    return letter(cell, wrong);
  };
  const bool ends_early = situation.aborted || std::string_view(situation.name) == "idle";
  EXPECT_EQ(try_with({}), ends_early ? 'e' : '.');
  std::string table;
  std::size_t pair = 0;
  for (std::size_t row = 0; row < all.size(); ++row) {
    table += fmt::format("  {:<32}", name_of(all[row]));
    for (std::size_t column = 0; column < row; ++column) {
      const bool two = all[row].device != all[column].device;
      const bool left_out = two && pair++ % kEvery != 0;
      table += !two || left_out ? ' ' : try_with({all[column], all[row]});
    }
    table += try_with({all[row]});
    table += '\n';
  }
  fmt::print("{}: {} cells, the longest {:.1f} s of bench time ({})\n{}", situation.name, cells,
             drivers::to_seconds(longest), slowest, table);
  if (kEvery == 1) {
    EXPECT_EQ(cells, 671U);
  }
}

INSTANTIATE_TEST_SUITE_P(All, SafetyMatrix, testing::Range(std::size_t{0}, situations().size()),
                         [](const testing::TestParamInfo<std::size_t>& tried) {
                           return situations()[tried.param].name;
                         });

}  // namespace
}  // namespace fogbench::system_test
