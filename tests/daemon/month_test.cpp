// A month of nights on the simulated bench in virtual time: thirty nights of three to four runs
// each, with faults of every instrument, prompts answered late or with no, pauses and aborts at
// random by a recorded seed. Every run is accounted for, and the process does not grow.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <random>

#include "daemon/desk_operator.hpp"
#include "daemon/desk_recorder.hpp"
#include "record/run_log.hpp"
#include "record/run_log_reader.hpp"
#include "tests/support/source_tree.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fogbench::daemon {
namespace {

constexpr std::uint32_t kSeed = 20261122;
constexpr int kNights = 30;

double resident_mb() {
  std::ifstream in("/proc/self/statm");
  std::size_t all = 0, resident = 0;
  in >> all >> resident;
  return static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

std::ptrdiff_t descriptors() {
  const std::filesystem::directory_iterator files("/proc/self/fd");
  return std::distance(begin(files), end(files));
}

/// A fault every seven hours or so, of any instrument: seconds of silence, wrong answers, a pulled
/// plug.
std::vector<config::FaultSpec> faults(std::mt19937& random) {
  using config::FaultKind;
  const std::vector<std::pair<const char*, std::vector<FaultKind>>> kinds{
      {"thermostat", {FaultKind::kTimeout, FaultKind::kException, FaultKind::kNan}},
      {"coil_horizontal", {FaultKind::kTimeout, FaultKind::kUnplug, FaultKind::kGarbage}},
      {"coil_vertical", {FaultKind::kTimeout, FaultKind::kUnplug, FaultKind::kSilentExecution}},
      {"magnetometer", {FaultKind::kUnplug, FaultKind::kBadSequence, FaultKind::kStuck}},
      {"gyro", {FaultKind::kBadChecksum, FaultKind::kUnplug, FaultKind::kTimeout}}};
  std::vector<config::FaultSpec> all;
  std::uniform_real_distribution<double> pause_s(3600.0, 13.0 * 3600.0), lasts_s(1.0, 45.0);
  for (double at_s = 1800.0; at_s < kNights * 14.0 * 3600.0; at_s += pause_s(random)) {
    const auto& [device, possible] = kinds[random() % kinds.size()];
    config::FaultSpec fault;
    fault.device = device;
    fault.kind = possible[random() % possible.size()];
    fault.at = config::Seconds{at_s};
    fault.duration = config::Seconds{lasts_s(random)};
    all.push_back(fault);
  }
  return all;
}

TEST(Month, OfNightsWithFaultsAndPromptsLeavesNothingBehindAndLosesNoRun) {
  const auto ready = tests::source_tree() / "config";
  auto setup = load_setup(
      {(ready / "benches/simulated.json").string(), (ready / "scenarios/clean.json").string()});
  ASSERT_TRUE(setup) << setup.error().message;
  setup->bench.gyro.device.frame_rate_hz = 10.0;
  std::mt19937 random(kSeed);
  const auto faulty = faults(random);
  ASSERT_GT(faulty.size(), 40U);
  setup->scenario.faults = faulty;

  const support::TemporaryFolder folder;
  const auto asks = folder.file("asks.json", R"({"name": "asks", "steps": [
      {"step": "prompt", "text": "Put the gyro in, then confirm."},
      {"step": "average", "duration_s": 600, "segment": "a"}]})");
  std::vector<PlannedProcedure> procedures;
  for (const std::string& name :
       {(ready / "procedures/coil-sweep.json").string(),
        (ready / "procedures/thermostat-steps.json").string(),
        (ready / "procedures/static-record.json").string(), asks.string()}) {
    auto planned = plan_procedure(name, setup->bench, {});
    ASSERT_TRUE(planned) << planned.error().message;
    procedures.push_back(std::move(*planned));
  }

  const std::filesystem::path store = folder / "store.db";
  const auto log = record::RunLog::open(store);
  ASSERT_TRUE(log) << log.error().message;
  RunDesk desk;
  DeskRecorder record(**log, desk);
  DeskOperator person(desk);
  const auto session = Session::open(std::move(*setup), kSeed, record, Speed::kMaximum, person);
  ASSERT_TRUE(session) << session.error().message;
  procedures::RunEngine& engine = (*session)->engine();
  desk.attach(engine);
  person.attach(engine);

  // The people: on the bench's thread, between its ticks.
  const Person somebody{"alice", 1000};
  int answers = 0, pauses = 0, aborts = 0;
  engine.on_progress([&](const procedures::Progress& now) {
    desk.progressed(now);
    const auto one_in = [&random](unsigned n) { return random() % n == 0; };
    const DeskView view = desk.view();
    if (view.question && one_in(900)) {
      answers += desk.answer(view.question->prompt, !one_in(10), somebody) ? 0 : 1;
    } else if (view.run && view.run->pause_requested) {
      if (one_in(600)) (void)desk.resume(somebody);
    } else if (one_in(20000)) {
      pauses += desk.pause(somebody) ? 0 : 1;
    } else if (one_in(50000)) {
      aborts += desk.abort(somebody) ? 0 : 1;
    }
  });

  std::map<std::string, int> outcomes;
  double early_mb = 0.0;
  std::ptrdiff_t early_descriptors = 0;
  int runs = 0;
  for (int night = 0; night < kNights; ++night) {
    for (const PlannedProcedure& procedure : procedures) {
      if (random() % 6 == 0) continue;
      ASSERT_EQ(desk.enqueue({}, procedure, somebody).index(), 0U);
      const auto job = desk.next_job();
      ASSERT_TRUE(job);
      const auto summary = (*session)->run(job->procedure, job->by.name);
      desk.run_ended(summary);
      if (desk.view().held()) (void)desk.resume(somebody);
      ++runs;
      // An instrument that is silent at the start is why a run is not begun: nothing is on record.
      ++outcomes[summary ? std::string(name_of(summary->end.outcome)) : "not begun"];
      // One that is still silent then is tried again until it answers, as the daemon does.
      for (int tries = 0; summary && !summary->end.safe_state_reached; ++tries) {
        if ((*session)->make_safe().reached()) break;
        ASSERT_LT(tries, 60) << summary->end.reason;
        (*session)->clock().sleep_for(std::chrono::seconds{1});
      }
    }
    if (night == 4) {
      early_mb = resident_mb();
      early_descriptors = descriptors();
    }
  }
  const double grown_mb = resident_mb() - early_mb;
  RecordProperty("grown_mb", fmt::format("{:.1f}", grown_mb));
  EXPECT_LT(grown_mb, 5.0) << "from the fifth night to the thirtieth";
  EXPECT_EQ(descriptors(), early_descriptors);

  const auto reader = record::RunLogReader::open(store);
  ASSERT_TRUE(reader) << reader.error().message;
  const auto stored = (*reader)->runs();
  ASSERT_TRUE(stored) << stored.error().message;
  EXPECT_EQ(static_cast<int>(stored->size()), runs - outcomes["not begun"]);
  std::map<std::string, int> recorded;
  for (const record::StoredRun& run : *stored) ++recorded[run.outcome()];
  for (const char* outcome : {"completed", "aborted", "failed", "interrupted"}) {
    EXPECT_EQ(recorded[outcome], outcomes[outcome]) << outcome;
  }
  // The month must have been an eventful one for this to have tried anything.
  fmt::print(
      "{} runs: {} completed, {} aborted, {} failed, {} not begun; {} faults, {} answers, {} "
      "pauses, {} aborts; {:+.1f} MB\n",
      runs, outcomes["completed"], outcomes["aborted"], outcomes["failed"], outcomes["not begun"],
      faulty.size(), answers, pauses, aborts, grown_mb);
  EXPECT_GT(outcomes["completed"], 40);
  EXPECT_GT(answers, 10);
  EXPECT_GT(pauses, 10);
  EXPECT_GT(aborts, 2);
}

}  // namespace
}  // namespace fogbench::daemon
