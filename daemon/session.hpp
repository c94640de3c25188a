#pragma once
// One bench, opened and ready, and its run log: what `fogbench dry-run` and fogbenchd share.
// Everything that can be wrong with the files is found by load_setup and plan_procedure, before
// Session::open touches a device or writes a byte.

#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "config/bench.hpp"
#include "config/result.hpp"
#include "config/scenario.hpp"
#include "daemon/gyro_on_line.hpp"
#include "daemon/operator_on_record.hpp"
#include "drivers/clock.hpp"
#include "drivers/instruments.hpp"
#include "drivers/open_bench.hpp"
#include "drivers/safe_state.hpp"
#include "procedures/plan.hpp"
#include "procedures/run_engine.hpp"
#include "record/run_log.hpp"

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
  /// Of a bench faster than real, whose calendar is its own: Unix time in s at which it begins,
  /// where the machine's is earlier. So what a run log tells of two daemons stays in its order.
  double calendar_from_unix_s = 0.0;
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
  std::optional<SwitchedOn> switched_on;  ///< as somebody says; empty: as the line says
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
  /// The bench, and nothing said to any instrument. `person` must outlive the session. Errors:
  /// kBadInput, or kDevice for an instrument that another program has.
  static Result<std::unique_ptr<Session>> attach(Setup setup, std::uint64_t seed, Speed speed,
                                                 drivers::Operator& person);
  /// Before anything is judged: coils to 0 A, heaters off, on every instrument that can be reached.
  drivers::SafetyReport make_safe() { return drivers::make_safe(bench_); }
  /// Begins every instrument. May be repeated until it succeeds. Errors: the instruments'.
  Status begin() { return drivers::begin_bench(bench_); }
  /// When all have begun: runs are recorded in `record` from now on, which must outlive the
  /// session.
  void record_in(procedures::Recorder& record);

  /// Attached, made safe and begun, and the run log opened. What cannot be reached is tried three
  /// times, a second apart; the error then says how far each actuator came. Errors: as above, and
  /// kStore.
  static Result<std::unique_ptr<Session>> open(Setup setup, std::uint64_t seed,
                                               const std::filesystem::path& store, Speed speed,
                                               drivers::Operator& person);
  /// The same with a record of the caller's own: no run log.
  static Result<std::unique_ptr<Session>> open(Setup setup, std::uint64_t seed,
                                               procedures::Recorder& record, Speed speed,
                                               drivers::Operator& person);

  /// Runs one procedure to its end in the safe state. `operator_name` is for the record, may be
  /// empty. Errors: as RunEngine::run.
  /// kDevice when it takes up a run that other instruments measured.
  Result<procedures::RunSummary> run(const PlannedProcedure& procedure,
                                     const std::string& operator_name = {});
  /// Precondition: record_in.
  procedures::RunEngine& engine() { return *engine_; }
  /// The bench's. Each run takes the machine's calendar over when it begins.
  drivers::Clock& clock() { return *clock_; }
  /// Between runs, several times a second at best: hears whether the gyro falls silent, which is
  /// how it is known that it was switched off. What it says has happened, empty for nothing.
  std::string listen();
  /// Of the gyro's stream, on the thread of run().
  const drivers::StreamStatistics& stream() const { return bench_.gyro->statistics(); }

  /// Any thread: 0 A to both coil supplies, for a process that ends now. False on a simulated
  /// bench, which ends with it.
  bool send_last_zero() noexcept;

 private:
  Session(Setup setup, std::uint64_t seed, Speed speed, drivers::Operator& person)
      : setup_(std::move(setup)), seed_(seed), speed_(speed), person_(person) {}

  /// Before a run: whose frames these are, and since when it operates.
  Status take_gyro(const PlannedProcedure& procedure, procedures::RunHeader& header);

  static Result<std::unique_ptr<Session>> begun(Setup setup, std::uint64_t seed, Speed speed,
                                                drivers::Operator& person);

  Setup setup_;
  std::uint64_t seed_;
  Speed speed_;
  OperatorOnRecord person_;
  std::unique_ptr<drivers::Clock> clock_;
  std::unique_ptr<record::RunLog> log_;  ///< null when the record is the caller's
  drivers::Bench bench_;
  std::function<void()> exchange_gyro_;  ///< of a simulated bench
  std::optional<GyroOnLine> line_;       ///< once the bench has begun
  std::unique_ptr<procedures::RunEngine> engine_;
};

/// A seed that nobody chose, short enough to be typed again.
std::uint64_t random_seed();

}  // namespace fogbench::daemon
