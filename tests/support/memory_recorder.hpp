#pragma once
// A run log in memory, for tests of what is recorded and in which order. Any call can be made to
// fail.

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "procedures/recorder.hpp"

namespace fogbench::test {

class MemoryRecorder final : public procedures::Recorder {
 public:
  struct Event {
    double time_s;
    std::string severity, message, data_json;
  };
  struct Step {
    std::string path, what, evidence;
    bool ended = false;
  };

  Result<std::int64_t> begin_run(
      const procedures::RunHeader& header,
      const std::vector<procedures::InstrumentRecord>& instruments) override {
    if (fails("begin_run")) return failure();
    headers.push_back(header);
    instrument_records = instruments;
    return static_cast<std::int64_t>(headers.size());
  }
  Status step_started(const std::string& path, const std::string& what, double) override {
    if (fails("step_started")) return failure();
    steps.push_back({path, what, {}, false});
    return {};
  }
  Status step_ended(const std::string& path, double, const std::string& evidence) override {
    if (fails("step_ended")) return failure();
    const auto step =
        std::find_if(steps.rbegin(), steps.rend(), [&](const Step& s) { return s.path == path; });
    step->ended = true;
    step->evidence = evidence;
    return {};
  }
  Status event(double time_s, const std::string& severity, const std::string& message,
               const std::string& data_json) override {
    if (fails("event")) return failure();
    events.push_back({time_s, severity, message, data_json});
    return {};
  }
  Status point(const procedures::Point& point) override {
    if (fails("point")) return failure();
    points.push_back(point);
    return {};
  }
  /// As the run log does it: void points stay on record.
  Status void_block(int block, double, const std::string& reason) override {
    if (fails("void_block")) return failure();
    for (const auto& p : points) {
      if (p.block == block) void_points.push_back(p);
    }
    std::erase_if(points, [&](const procedures::Point& p) { return p.block == block; });
    void_reasons.push_back(reason);
    return {};
  }
  Status monitor(const procedures::MonitorRow& row) override {
    if (fails("monitor")) return failure();
    rows.push_back(row);
    return {};
  }
  Status gyro_samples(const drivers::GyroBlock& block) override {
    if (fails("gyro_samples")) return failure();
    frames += block.index.size();
    return {};
  }
  Status end_run(const procedures::RunEnd& end) override {
    if (fails("end_run")) return failure();
    ends.push_back(end);
    return {};
  }

  bool has_event(const std::string& text) const {
    return std::any_of(events.begin(), events.end(),
                       [&](const Event& e) { return e.message.find(text) != std::string::npos; });
  }

  std::function<bool(const std::string&)> fails = [](const std::string&) { return false; };
  std::vector<procedures::RunHeader> headers;
  std::vector<procedures::InstrumentRecord> instrument_records;
  std::vector<Step> steps;
  std::vector<Event> events;
  std::vector<procedures::Point> points, void_points;
  std::vector<std::string> void_reasons;
  std::vector<procedures::MonitorRow> rows;
  std::size_t frames = 0;
  std::vector<procedures::RunEnd> ends;

 private:
  static Error failure() { return Error{ErrorCode::kStore, "run log: disk full"}; }
};

}  // namespace fogbench::test
