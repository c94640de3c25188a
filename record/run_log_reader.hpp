#pragma once
// Reads a run log, also while another program writes it.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "config/result.hpp"
#include "procedures/recorder.hpp"
#include "record/run_log.hpp"
#include "record/sqlite.hpp"

namespace fogbench::record {

struct StoredRun {
  std::int64_t run = 0;
  procedures::RunHeader header;           ///< of a continuation: run and first step
  std::int64_t taken_up_by = 0;           ///< 0: by none
  std::optional<procedures::RunEnd> end;  ///< empty: under way, or interrupted
  bool under_way = false;                 ///< somebody was writing it when it was read
  std::string raw_sha256;                 ///< over the chunks' hashes; empty when interrupted
  std::int64_t points = 0;
  std::int64_t points_void = 0;
  std::int64_t frames_stored = 0;

  bool completed() const { return end && end->outcome == procedures::RunOutcome::kCompleted; }
  /// "completed", "aborted", "failed", "interrupted" or "under way".
  std::string outcome() const;
};

struct StoredPoint {
  procedures::Point point;
  std::string void_because;  ///< empty: valid
};

struct StoredEvent {
  double time_s = 0.0;
  std::string severity, message, data_json;
};

struct StoredBenchEvent : BenchEvent {
  std::string bench;
};

struct StoredStep {
  std::string path, says;
  double started_s = 0.0, ended_s = 0.0;  ///< NaN: not ended
  std::string evidence;
};

/// Errors of every call: kStore. One thread.
class RunLogReader {
 public:
  /// Errors: as open_store.
  static Result<std::unique_ptr<RunLogReader>> open(const std::filesystem::path& path);

  Result<std::vector<StoredRun>> runs();
  /// kBadInput when there is no such run.
  Result<StoredRun> run(std::int64_t run);
  /// The run, and before it those that it takes up, oldest first.
  Result<std::vector<StoredRun>> chain(std::int64_t run);
  /// Of the run alone, in time order, void ones too.
  Result<std::vector<StoredPoint>> points(std::int64_t run);
  /// Of the whole chain, in time order, void ones too, on one axis of time: that of its first run.
  /// The gaps between the runs are in it as they were by the bench's calendar; where that was set
  /// back meanwhile, a run follows right after the one before.
  Result<std::vector<StoredPoint>> chain_points(std::int64_t run);
  Result<std::vector<procedures::InstrumentRecord>> instruments(std::int64_t run);
  Result<std::vector<StoredEvent>> events(std::int64_t run);
  /// Of all benches, in the order in which they were written; none in an older log.
  Result<std::vector<StoredBenchEvent>> bench_events();
  Result<std::vector<StoredStep>> steps(std::int64_t run);
  /// The run's last trace, seconds since power-on; 0 when there is none.
  /// When the run's times were 0, as Unix time in s, by the calendar that its dates follow.
  Result<double> zero_unix_s(const StoredRun& run);
  Result<double> last_time(std::int64_t run);
  /// How far the machine's clock was set forward during the run, in all; negative: back.
  Result<double> clock_steps_s(std::int64_t run);
  /// Whether some program writes it at this moment.
  bool being_written(std::int64_t run) const;
  /// Calls `use` with each chunk of the raw stream in turn and stops at its first error. A damaged
  /// chunk is kStore, with its number.
  Status read_gyro(std::int64_t run,
                   const std::function<Status(const drivers::GyroBlock& block)>& use);
  /// The hash that the run's chunks have now: of an untouched run its raw_sha256.
  Result<std::string> raw_sha256(std::int64_t run);

 private:
  RunLogReader(std::unique_ptr<Database> database, std::filesystem::path path);
  StoredRun read(const Statement& row) const;
  Result<std::vector<std::string>> number_columns(const std::string& table);
  std::string select_runs() const;
  std::unique_ptr<Database> database_;
  std::filesystem::path path_;
  bool has_continuations_ = true;  ///< false: of a schema that did not know them
};

}  // namespace fogbench::record
