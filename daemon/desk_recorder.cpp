#include "daemon/desk_recorder.hpp"

namespace fogbench::daemon {

Result<std::int64_t> DeskRecorder::begin_run(
    const procedures::RunHeader& header,
    const std::vector<procedures::InstrumentRecord>& instruments) {
  auto run = record_.begin_run(header, instruments);
  if (!run) return run;
  time_s_ = 0.0;
  notes_.clear();
  desk_.run_begun(*run);
  return run;
}

Status DeskRecorder::step_started(const std::string& path, const std::string& what, double time_s) {
  time_s_ = time_s;
  return record_.step_started(path, what, time_s);
}

Status DeskRecorder::step_ended(const std::string& path, double time_s,
                                const std::string& evidence) {
  time_s_ = time_s;
  return record_.step_ended(path, time_s, evidence);
}

Status DeskRecorder::event(double time_s, const std::string& severity, const std::string& message,
                           const std::string& data_json) {
  time_s_ = time_s;
  const Status recorded = record_.event(time_s, severity, message, data_json);
  if (recorded) desk_.saw(SeenEvent{time_s, severity, message});
  return recorded;
}

Status DeskRecorder::point(const procedures::Point& point) {
  const Status recorded = record_.point(point);
  if (recorded) desk_.saw(point);
  return recorded;
}

Status DeskRecorder::void_block(int block, double time_s, const std::string& reason) {
  time_s_ = time_s;
  const Status recorded = record_.void_block(block, time_s, reason);
  if (recorded) desk_.voided(block);
  return recorded;
}

Status DeskRecorder::monitor(const procedures::MonitorRow& row) {
  time_s_ = row.time_s;
  if (const Status recorded = record_.monitor(row); !recorded) return recorded;
  desk_.saw(row);
  record_bench_events();
  return record_notes();
}

Status DeskRecorder::gyro_samples(const drivers::GyroBlock& block) {
  return record_.gyro_samples(block);
}

Status DeskRecorder::end_run(const procedures::RunEnd& end) {
  desk_.run_ending(end);
  const Status noted = record_notes();
  const Status ended = record_.end_run(end);
  record_bench_events();
  return noted ? ended : noted;
}

void DeskRecorder::record_bench_events() {
  for (record::BenchEvent& event : desk_.take_bench_events()) {
    if (bench_events_.size() == kMostKept) bench_events_.pop_front();
    bench_events_.push_back(std::move(event));
  }
  while (!bench_events_.empty()) {
    if (write_bench_event_ && !write_bench_event_(bench_events_.front())) return;
    bench_events_.pop_front();
  }
}

Status DeskRecorder::record_notes() {
  for (Note& note : desk_.take_notes()) notes_.push_back(std::move(note));
  while (!notes_.empty()) {
    const Status recorded =
        event(time_s_, "info", notes_.front().message, notes_.front().data_json);
    if (!recorded) return recorded;
    notes_.erase(notes_.begin());
  }
  return {};
}

}  // namespace fogbench::daemon
