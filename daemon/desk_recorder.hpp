#pragma once
// A recorder that hands everything on to another and shows the desk what has been recorded: nobody
// sees what is not on record. What people did comes back from the desk and is recorded as events
// of the run, with who did it, at the next reading of the instruments or before the run's end.
// On the bench's thread.

#include <deque>
#include <functional>
#include <string>
#include <vector>

#include "daemon/run_desk.hpp"
#include "procedures/recorder.hpp"

namespace fogbench::daemon {

class DeskRecorder final : public procedures::Recorder {
 public:
  using WriteBenchEvent = std::function<Status(const record::BenchEvent&)>;
  /// All must outlive it. What happens outside of runs goes to `write`, if any.
  DeskRecorder(procedures::Recorder& record, RunDesk& desk, WriteBenchEvent write = {})
      : record_(record), desk_(desk), write_bench_event_(std::move(write)) {}

  /// Within a run it is done by itself. What cannot be written is kept for the next time, up to
  /// kMostKept of it.
  void record_bench_events();
  static constexpr std::size_t kMostKept = 1000;

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

 private:
  Status record_notes();

  procedures::Recorder& record_;
  RunDesk& desk_;
  WriteBenchEvent write_bench_event_;
  std::vector<Note> notes_;                      ///< not on record yet
  std::deque<record::BenchEvent> bench_events_;  ///< likewise
  double time_s_ = 0.0;                          ///< of the run's last record
};

}  // namespace fogbench::daemon
