// A process that is killed at any moment of a run loses nothing that it has reported, and the run
// that takes its run up ends with the measurements of one that nobody killed. Each case forks a
// process which runs a procedure on the simulated bench in virtual time and kills itself with
// SIGKILL when the chosen record has been made: after each record of the run (51 kills), at 200
// readings of the instruments drawn by a fixed seed, and again and again while the run is taken up
// (50 kills of 20 runs). The journal of a killed process is then cut at 640 lengths.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>

#include <csignal>
#include <fstream>
#include <random>

#include "daemon/resumption.hpp"
#include "daemon/simulated_operator.hpp"
#include "record/export.hpp"
#include "tests/support/source_tree.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fogbench::daemon {
namespace {

namespace fs = std::filesystem;
using procedures::Point;
using procedures::PointKind;

// A little of everything: transients, a nulled field, a block, a heating, a turn.
constexpr auto kProcedure = R"({
  "name": "little", "steps": [
    {"step": "wait", "operating_time_s": 30, "segment": "warm_up", "window_s": 5},
    {"step": "rotate", "azimuth_deg": 0},
    {"step": "compensate_field", "tolerance_ut": 0.2},
    {"step": "baseline", "duration_s": 5, "segment": "baseline"},
    {"step": "sweep", "axis": "x", "levels_ut": [0, 100, -100, 0], "duration_s": 5, "settle_s": 2,
     "segment": "coil_x"},
    {"step": "set_temperature", "target_c": 24, "mode": "boost"},
    {"step": "settle_temperature", "band_c": 0.5, "dwell_s": 60, "slope_c_per_h": 20,
     "timeout_s": 7200, "segment": "heating", "window_s": 30},
    {"step": "average", "duration_s": 5, "segment": "plateau"},
    {"step": "prompt", "text": "Turn the gyro, then confirm."},
    {"step": "rotate", "azimuth_deg": 90},
    {"step": "average", "duration_s": 5, "segment": "turned"}]})";

// Noise would hide what a wrong field or a wrong temperature does.
constexpr auto kScenario = R"({
  "name": "quiet", "noise": "none", "reference_temperature_c": 21,
  "gyro": {"terms": {"bias": 1.3, "temperature_linear": -0.1, "magnetic_linear_x": 1.0}}})";

enum class Deadly { kRecord, kReading };

/// Kills its process when the n-th record (or reading of the instruments) has been made.
class DeadlyRecorder final : public procedures::Recorder {
 public:
  DeadlyRecorder(procedures::Recorder& record, Deadly deadly, int left)
      : record_(record), deadly_(deadly), left_(left) {}

  Result<std::int64_t> begin_run(
      const procedures::RunHeader& header,
      const std::vector<procedures::InstrumentRecord>& instruments) override {
    auto run = record_.begin_run(header, instruments);
    count(Deadly::kRecord);
    return run;
  }
  Status step_started(const std::string& path, const std::string& what, double time_s) override {
    return counted(record_.step_started(path, what, time_s));
  }
  Status step_ended(const std::string& path, double time_s, const std::string& why) override {
    return counted(record_.step_ended(path, time_s, why));
  }
  Status event(double time_s, const std::string& severity, const std::string& message,
               const std::string& data_json) override {
    return counted(record_.event(time_s, severity, message, data_json));
  }
  Status point(const Point& point) override { return counted(record_.point(point)); }
  Status void_block(int block, double time_s, const std::string& reason) override {
    return counted(record_.void_block(block, time_s, reason));
  }
  Status monitor(const procedures::MonitorRow& row) override {
    Status recorded = record_.monitor(row);
    count(Deadly::kReading);
    return recorded;
  }
  Status gyro_samples(const drivers::GyroBlock& block) override {
    return record_.gyro_samples(block);
  }
  Status end_run(const procedures::RunEnd& end) override { return counted(record_.end_run(end)); }

  int left() const { return left_; }

 private:
  Status counted(Status recorded) {
    count(Deadly::kRecord);
    return recorded;
  }
  void count(Deadly what) {
    if (what == deadly_ && --left_ == 0) raise(SIGKILL);
  }

  procedures::Recorder& record_;
  Deadly deadly_;
  int left_;
};

/// What a process that is about to die has told others.
struct Reported {
  int points = 0;
};

class KillMatrix : public testing::Test {
 protected:
  KillMatrix()
      : procedure_(folder_.file("little.json", kProcedure)),
        scenario_(folder_.file("quiet.json", kScenario)) {}

  daemon::Setup setup() const {
    auto setup =
        load_setup({(tests::source_tree() / "config/benches/simulated.json").string(), scenario_});
    EXPECT_TRUE(setup) << setup.error().message;
    return std::move(*setup);
  }

  /// Runs the procedure, or takes up a run, until the end or the kill. Returns the kills left.
  int run(const fs::path& store, std::int64_t take_up, Deadly deadly, int kill_at,
          Reported* reported) const {
    daemon::Setup made = setup();
    auto planned = plan_procedure(procedure_, made.bench, {});
    if (take_up != 0) {
      const auto log = record::RunLogReader::open(store);
      planned = plan_resumption(**log, take_up, made);
    }
    EXPECT_TRUE(planned) << planned.error().message;
    const auto log = record::RunLog::open(store);
    DeadlyRecorder record(**log, deadly, kill_at);
    SimulatedOperator person;
    const auto session = Session::open(std::move(made), 5, record, Speed::kMaximum, person);
    EXPECT_TRUE(session) << session.error().message;
    if (reported != nullptr) {
      (*session)->engine().on_point([reported](const Point&) { ++reported->points; });
    }
    const auto summary = (*session)->run(*planned);
    EXPECT_TRUE(summary) << summary.error().message;
    EXPECT_EQ(summary->end.outcome, procedures::RunOutcome::kCompleted) << summary->end.reason;
    EXPECT_TRUE(summary->end.safe_state_reached);
    return record.left();
  }

  /// The same in a process that kills itself. False: it came to its end.
  bool run_and_kill(const fs::path& store, std::int64_t take_up, Deadly deadly, int kill_at) {
    reported_->points = 0;
    const pid_t child = fork();
    if (child == 0) {
      run(store, take_up, deadly, kill_at, reported_);
      _exit(testing::Test::HasFailure() ? 1 : 0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status) || WEXITSTATUS(status) == 0);
    return WIFSIGNALED(status);
  }

  static std::vector<Point> points_of(const fs::path& store, std::int64_t run) {
    const auto log = record::RunLogReader::open(store);
    EXPECT_TRUE(log) << log.error().message;
    auto points = record::valid_points(**log, run, true);
    return points ? std::move(*points) : std::vector<Point>{};
  }
  static std::int64_t last_run(const fs::path& store) {
    const auto log = record::RunLogReader::open(store);
    const auto runs = (*log)->runs();
    return runs && !runs->empty() ? runs->back().run : 0;
  }

  /// The undisturbed run, made once.
  const std::vector<Point>& undisturbed() {
    if (whole_.empty()) {
      const fs::path store = folder_ / "whole.db";
      records_ = 100000 - run(store, 0, Deadly::kRecord, 100000, nullptr);
      readings_ = 100000 - run(folder_ / "again.db", 0, Deadly::kReading, 100000, nullptr);
      whole_ = points_of(store, 1);
    }
    return whole_;
  }

  void expect_the_same(const std::vector<Point>& points, const std::string& where) {
    const auto averages = [](const std::vector<Point>& all) {
      std::vector<Point> kept;
      for (const Point& point : all) {
        if (point.segment != "heating") kept.push_back(point);
      }
      return kept;
    };
    const std::vector<Point> expected = averages(undisturbed()), found = averages(points);
    ASSERT_EQ(found.size(), expected.size()) << where;
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].segment, expected[i].segment) << where << ", point " << i;
      EXPECT_EQ(found[i].azimuth_deg, expected[i].azimuth_deg) << where;
      // Within what the settled band leaves open: 0.5 degC are 0.05 deg/h, 1 uT is 0.01 deg/h.
      EXPECT_NEAR(found[i].rate_deg_per_h, expected[i].rate_deg_per_h, 0.06) << where;
      EXPECT_NEAR(found[i].field_x_ut, expected[i].field_x_ut, 1.0) << where;
    }
    // A rise is all of one piece: as long as the other one, give or take a window at either end.
    const auto rise = [](const std::vector<Point>& all) {
      return std::count_if(all.begin(), all.end(),
                           [](const Point& point) { return point.segment == "heating"; });
    };
    EXPECT_NEAR(static_cast<double>(rise(points)), static_cast<double>(rise(undisturbed())), 2.0)
        << where;
    for (std::size_t i = 1; i < points.size(); ++i) {
      EXPECT_GE(points[i].time_s - points[i].duration_s / 2.0 + 1e-6,
                points[i - 1].time_s + points[i - 1].duration_s / 2.0)
          << where << ": measured twice";
    }
  }

  /// Kills, takes up (killed `more` times meanwhile), and compares.
  void kill_and_take_up(Deadly deadly, int kill_at, int more = 0) {
    const std::string where =
        fmt::format("killed at {} {}", deadly == Deadly::kRecord ? "record" : "reading", kill_at);
    const fs::path store = folder_ / "killed.db";
    for (const char* suffix : {"", "-wal", "-shm"}) fs::remove(store.string() + suffix);
    if (!run_and_kill(store, 0, deadly, kill_at)) return;
    ++kills_;
    std::int64_t last = last_run(store);
    ASSERT_EQ(last, 1) << where;
    ASSERT_GE(points_of(store, last).size(), static_cast<std::size_t>(reported_->points)) << where;
    for (int i = 0; i < more; ++i) {
      const bool killed = run_and_kill(store, last, deadly, kill_at / 2 + i);
      kills_ += killed ? 1 : 0;
      last = last_run(store);
      if (!killed) break;
    }
    const auto log = record::RunLogReader::open(store);
    const auto stored = (*log)->run(last);
    ASSERT_TRUE(stored);
    // The last record is the end itself: nothing is left to take up.
    if (!stored->completed()) {
      run(store, last, Deadly::kRecord, 0, nullptr);
      last = last_run(store);
    }
    expect_the_same(points_of(store, last), where);
  }

  support::TemporaryFolder folder_;
  std::string procedure_, scenario_;
  std::vector<Point> whole_;
  int records_ = 0, readings_ = 0, kills_ = 0;
  Reported* reported_ = static_cast<Reported*>(
      mmap(nullptr, sizeof(Reported), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));
};

TEST_F(KillMatrix, AfterEveryRecordTheRunIsTakenUpWithNothingLostOrDoubled) {
  ASSERT_FALSE(undisturbed().empty());
  for (int record = 1; record <= records_ && !HasFailure(); ++record) {
    kill_and_take_up(Deadly::kRecord, record);
  }
  RecordProperty("kills", kills_);
  EXPECT_EQ(kills_, records_);
  EXPECT_GE(kills_, 40);
}

TEST_F(KillMatrix, AtAnyReadingToo) {
  ASSERT_FALSE(undisturbed().empty());
  std::mt19937 random(20261122);
  for (int i = 0; i < 200 && !HasFailure(); ++i) {
    kill_and_take_up(Deadly::kReading, std::uniform_int_distribution<int>(1, readings_)(random));
  }
  EXPECT_EQ(kills_, 200);
}

TEST_F(KillMatrix, ARunThatTakesUpAnotherMayBeKilledItself) {
  ASSERT_FALSE(undisturbed().empty());
  std::mt19937 random(20261123);
  for (int i = 0; i < 20 && !HasFailure(); ++i) {
    kill_and_take_up(Deadly::kRecord, std::uniform_int_distribution<int>(4, records_)(random), 2);
  }
  RecordProperty("kills", kills_);
  EXPECT_GE(kills_, 40);
}

TEST_F(KillMatrix, AJournalCutAnywhereIsReadUpToTheCut) {
  undisturbed();
  const fs::path store = folder_ / "killed.db", cut = folder_ / "cut.db";
  const daemon::Setup made = setup();
  ASSERT_TRUE(run_and_kill(store, 0, Deadly::kRecord, records_ - 4));
  const std::string wal = support::read_text(store.string() + "-wal");
  ASSERT_GT(wal.size(), 100000U);
  const std::string store_bytes = support::read_text(store.string());
  const auto write = [](const std::string& file, std::string_view bytes) {
    std::ofstream(file, std::ios::binary)
        .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  };
  std::size_t before = points_of(store, 1).size(), cuts = 0;
  // Every byte of the last ones, then a prime's distance: a frame counts whole or not at all.
  for (std::size_t length = wal.size(); length > 0 && !HasFailure();
       length -= std::min(length, wal.size() - length < 200 ? 1 : std::size_t{4999})) {
    // A reader that is the last to close moves the journal into the store.
    write(cut.string(), store_bytes);
    write(cut.string() + "-wal", std::string_view(wal).substr(0, length));
    fs::remove(cut.string() + "-shm");
    const auto log = record::RunLogReader::open(cut);
    ASSERT_TRUE(log) << length << " of " << wal.size() << " bytes: " << log.error().message;
    const auto interrupted = interrupted_runs(**log, made);
    ASSERT_TRUE(interrupted) << interrupted.error().message;
    const std::size_t points = points_of(cut, 1).size();
    EXPECT_LE(points, before);
    before = points;
    ++cuts;
    if (!interrupted->empty() && cuts % 10 == 0) {
      const auto planned = plan_resumption(**log, 1, made);
      EXPECT_TRUE(planned) << planned.error().message;
    }
  }
  RecordProperty("cuts", static_cast<int>(cuts));
  EXPECT_GT(cuts, 500U);
}

}  // namespace
}  // namespace fogbench::daemon
