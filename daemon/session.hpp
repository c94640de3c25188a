#pragma once
// One bench, opened and ready, and its run log: what `fogbench dry-run` and fogbenchd share.
// Everything that can be wrong with the files is found by load_setup and plan_procedure, before
// Session::open touches a device or writes a byte.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "config/bench.hpp"
#include "config/result.hpp"
#include "config/scenario.hpp"
#include "daemon/run_log.hpp"
#include "drivers/clock.hpp"
#include "drivers/instruments.hpp"
#include "procedures/plan.hpp"
#include "procedures/run_engine.hpp"

namespace fogbench::daemon {

/// Names as the user gave them: a file, or one of the ready ones.
struct SetupOptions {
  std::string bench = "simulated";
  std::string scenario = "clean";
};

/// A bench and what its simulated gyro hides, with the exact texts for the record.
struct Setup {
  config::BenchConfig bench;
  std::string bench_json;
  config::ScenarioConfig scenario;
  std::string scenario_json;  ///< empty on a real bench
  /// false: the instruments are reached where the bench's file says.
  bool simulated = true;
};

/// Errors: kBadInput.
Result<Setup> load_setup(const SetupOptions& options);

/// Whether all instruments are simulated; kBadInput when only some are. A turntable that the
/// operator turns is neither.
Result<bool> is_simulated(const config::BenchConfig& bench);

using config::Parameters;

/// What a run needs to know of the one that it takes up (resumption.hpp).
struct TakenUp {
  procedures::Continuation continuation;  ///< what it says is written when it begins
  std::vector<procedures::InstrumentRecord> instruments;  ///< as they were then
  double stopped_at_s = 0.0;  ///< its last trace by the bench's calendar, seconds since 1970
};

struct PlannedProcedure {
  procedures::Plan plan;
  std::string procedure_json;  ///< the texts of its files and the parameters given, for the record
  std::optional<TakenUp> takes_up;
  std::string gyro;  ///< serial number of the one that it measures; empty: nobody said
};

/// For the bench's gyro. Errors: kBadInput, kLimit.
Result<PlannedProcedure> plan_procedure(const std::string& name, const config::BenchConfig& bench,
                                        const Parameters& parameters);

/// Bench seconds a second.
struct Speed {
  static const Speed kRealtime;
  static const Speed kMaximum;  ///< on a virtual clock: as fast as the machine can

  double factor = 1.0;
  friend bool operator==(Speed, Speed) = default;
};
inline constexpr Speed Speed::kRealtime{1.0};
inline constexpr Speed Speed::kMaximum{std::numeric_limits<double>::infinity()};

class Session {
 public:
  /// Opens the bench, drives it to its safe state, and opens the run log. `person` must outlive the
  /// session. Errors: kStore, and the instruments'.
  static Result<std::unique_ptr<Session>> open(Setup setup, std::uint64_t seed,
                                               const std::filesystem::path& store, Speed speed,
                                               drivers::Operator& person);

  /// Makes the record; must outlive the session.
  using OpenRecord = std::function<Result<procedures::Recorder*>()>;
  /// The same with a record of the caller's own: no run log. `open_record` is called when the bench
  /// is in its safe state, so that no store, full or unreadable, keeps it from that.
  static Result<std::unique_ptr<Session>> open(Setup setup, std::uint64_t seed,
                                               const OpenRecord& open_record, Speed speed,
                                               drivers::Operator& person);
  static Result<std::unique_ptr<Session>> open(Setup setup, std::uint64_t seed,
                                               procedures::Recorder& record, Speed speed,
                                               drivers::Operator& person);

  /// Runs one procedure to its end in the safe state. `operator_name` is for the record, may be
  /// empty. Errors: as RunEngine::run.
  /// kDevice when it takes up a run that other instruments measured.
  Result<procedures::RunSummary> run(const PlannedProcedure& procedure,
                                     const std::string& operator_name = {});
  procedures::RunEngine& engine() { return *engine_; }
  /// The bench's. Each run takes the machine's calendar over when it begins.
  drivers::Clock& clock() { return *clock_; }
  /// Of the gyro's stream, on the thread of run().
  const drivers::StreamStatistics& stream() const { return bench_.gyro->statistics(); }

 private:
  Session(Setup setup, std::uint64_t seed) : setup_(std::move(setup)), seed_(seed) {}

  Setup setup_;
  std::uint64_t seed_;
  std::unique_ptr<drivers::Clock> clock_;
  std::unique_ptr<RunLog> log_;  ///< null when the record is the caller's
  drivers::Bench bench_;
  std::unique_ptr<procedures::RunEngine> engine_;
};

/// A seed that nobody chose, short enough to be typed again.
std::uint64_t random_seed();

}  // namespace fogbench::daemon
