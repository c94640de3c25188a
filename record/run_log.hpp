#pragma once
// The run log: everything that a run measured and did, in one SQLite file (run-log.md).
//
// A point, an event, the begin and the end of a run are committed and synced when the call
// returns. Steps are committed (they survive the death of the process, and the next point syncs
// them). Monitor rows wait for the next commit, at most kMonitorRows; gyro frames wait for a
// chunk of kChunkFrames. Memory does not grow with the run's length. The run under way is held
// (writing_lock.hpp), so that nobody takes it for an interrupted one.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "procedures/recorder.hpp"
#include "record/chunk_codec.hpp"
#include "record/sqlite.hpp"
#include "record/writing_lock.hpp"

namespace fogbench::record {

/// What happened on a bench outside its runs: who queued what, who was refused, a daemon that
/// began.
struct BenchEvent {
  double unix_s = 0.0;  ///< by the bench's calendar
  std::string severity = "info";
  std::string message;
  std::string gyro_serial_number;  ///< the one that it is about; empty: none
  std::string data_json;           ///< may be empty
};

class RunLog final : public procedures::Recorder {
 public:
  /// Makes the store when there is none. Errors: as open_store_for_writing.
  static Result<std::unique_ptr<RunLog>> open(const std::filesystem::path& path);
  ~RunLog() override;

  Result<std::int64_t> begin_run(
      const procedures::RunHeader& header,
      const std::vector<procedures::InstrumentRecord>& instruments) override;
  Status step_started(const std::string& path, const std::string& what, double time_s) override;
  Status step_ended(const std::string& path, double time_s, const std::string& evidence) override;
  Status event(double time_s, const std::string& severity, const std::string& message,
               const std::string& data_json) override;
  Status point(const procedures::Point& point) override;
  Status void_block(int block, double time_s, const std::string& reason) override;
  Status monitor(const procedures::MonitorRow& row) override;
  Status gyro_samples(const drivers::GyroBlock& block) override;
  Status end_run(const procedures::RunEnd& end) override;

  /// On disk when it returns, whether or not a run is under way.
  Status bench_event(const std::string& bench, const BenchEvent& event);

  /// Closes a run that nobody ended and nobody will take up.
  Status give_up(std::int64_t run, const std::string& reason);

 private:
  RunLog(std::unique_ptr<Database> database, std::unique_ptr<WritingLock> writing);
  /// The run's own channels, with a column each.
  Status take_channels(const std::vector<procedures::RunHeader::Auxiliary>& channels);
  Status prepare();
  /// Whether a commit waits for the disk: kFull outlives a power cut, kNormal the process's death.
  enum class Sync { kNormal, kFull };
  /// Runs `write` and whatever waits in one transaction.
  template <class Write>
  Status commit(Sync sync, Write write);
  Status check_free(std::int64_t run);
  Status take_up(const procedures::Continuation& before);
  Status write_monitor();
  Status write_chunk(std::size_t frames);
  Status write_end(const procedures::RunEnd& end);

  std::unique_ptr<Database> database_;  // before the statements: it goes after them
  struct Statements;
  std::unique_ptr<Statements> statements_;
  std::unique_ptr<WritingLock> writing_;
  Sync sync_ = Sync::kFull;  ///< as open_store_for_writing leaves it
  std::int64_t run_ = 0;
  std::int64_t step_ = 0;  ///< the row of the step under way
  std::int64_t chunk_ = 0;
  std::vector<std::byte> chunk_hashes_;
  std::vector<procedures::RunHeader::Auxiliary> auxiliary_;  ///< of the run under way
  std::vector<procedures::MonitorRow> monitor_;
  drivers::GyroBlock pending_;
  ChunkEncoder encoder_;
};

}  // namespace fogbench::record
