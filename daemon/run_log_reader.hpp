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
#include "daemon/sqlite.hpp"
#include "procedures/recorder.hpp"

namespace fogbench::daemon {

struct StoredRun {
  std::int64_t run = 0;
  procedures::RunHeader header;
  /// Empty: interrupted, or still under way in another program.
  std::optional<procedures::RunEnd> end;
  std::string raw_sha256;  ///< over the chunks' hashes; empty when interrupted
  std::int64_t points = 0;
  std::int64_t points_void = 0;
  std::int64_t frames_stored = 0;

  bool completed() const { return end && end->outcome == procedures::RunOutcome::kCompleted; }
  /// "completed", "aborted", "failed" or "interrupted".
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
  /// In time order, void ones too.
  Result<std::vector<StoredPoint>> points(std::int64_t run);
  Result<std::vector<procedures::InstrumentRecord>> instruments(std::int64_t run);
  Result<std::vector<StoredEvent>> events(std::int64_t run);
  Result<std::vector<StoredStep>> steps(std::int64_t run);
  /// Calls `use` with each chunk of the raw stream in turn and stops at its first error. A damaged
  /// chunk is kStore, with its number.
  Status read_gyro(std::int64_t run,
                   const std::function<Status(const drivers::GyroBlock& block)>& use);

 private:
  RunLogReader(std::unique_ptr<Database> database, std::filesystem::path path);
  std::unique_ptr<Database> database_;
  std::filesystem::path path_;
};

}  // namespace fogbench::daemon
