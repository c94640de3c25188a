#include "daemon/metrics.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <system_error>

#include "config/channels.hpp"
#include "config/output_file.hpp"
#include "daemon/desk_json.hpp"
#include "procedures/channel_values.hpp"

namespace fogbench::daemon {
namespace {

/// A label's value may hold anything but these three as they are.
std::string quotable(std::string_view value) {
  std::string text;
  for (const char c : value) {
    if (c == '\\' || c == '"') text += '\\';
    if (c == '\n') {
      text += "\\n";
    } else {
      text += c;
    }
  }
  return text;
}

class Exposition {
 public:
  void gauge(std::string_view name, std::string_view help) { family(name, "gauge", help); }
  void counter(std::string_view name, std::string_view help) { family(name, "counter", help); }
  /// Of the family that was named last.
  void sample(double value) { text_ += fmt::format("{} {}\n", name_, value); }
  void sample(std::string_view label, std::string_view label_value, double value) {
    text_ += fmt::format("{}{{{}=\"{}\"}} {}\n", name_, label, quotable(label_value), value);
  }
  void single(std::string_view name, std::string_view help, double value) {
    gauge(name, help);
    sample(value);
  }
  void counts(std::string_view name, std::string_view help, std::string_view label,
              const Counts& counts) {
    counter(name, help);
    for (const auto& [key, count] : counts) sample(label, key, static_cast<double>(count));
  }
  std::string text() && { return std::move(text_); }

 private:
  void family(std::string_view name, std::string_view type, std::string_view help) {
    name_ = fmt::format("fogbench_{}", name);
    text_ += fmt::format("# HELP {0} {1}\n# TYPE {0} {2}\n", name_, help, type);
  }

  std::string text_, name_;
};

void add_present_run(Exposition& out, const PresentRun& run) {
  const procedures::Progress& now = run.progress;
  out.single("run", "Number of the run under way, 0 while it starts", static_cast<double>(run.run));
  out.single("run_step", "Step of the run under way, from 1",
             static_cast<double>(std::min(now.step + 1, now.steps)));
  out.single("run_steps", "Steps of the run under way", static_cast<double>(now.steps));
  out.single("run_points", "Points of the run under way", static_cast<double>(run.points));
  out.single("run_elapsed_seconds", "Since the run's start, on the bench's clock",
             now.elapsed.count());
  out.single("run_remaining_seconds", "Until the run's end, as the plan estimates",
             now.remaining.count());
}

void add_last_run(Exposition& out, const EndedRun& run, const Counts& outcomes) {
  out.single("last_run", "Number of the run that ended last, 0: it could not be begun",
             static_cast<double>(run.run));
  out.gauge("last_run_outcome", "1 for the outcome of the run that ended last");
  for (const auto& [outcome, count] : outcomes) {
    out.sample("outcome", outcome, outcome == run.outcome ? 1.0 : 0.0);
  }
  out.single("last_run_safe", "Whether the run that ended last left the bench in its safe state",
             run.safe_state_reached ? 1.0 : 0.0);
}

void add_values(Exposition& out, const procedures::MonitorRow& row) {
  procedures::for_each_value(row, [&](std::string_view name, double value) {
    // The time has a metric of its own; what an instrument did not say is left out.
    if (name == "time_s" || !std::isfinite(value)) return;
    const config::Channel* const channel = config::find_channel(name);
    out.single(name,
               fmt::format("Last reading: {}",
                           channel != nullptr ? channel->meaning : "an auxiliary sensor's"),
               value);
  });
}

}  // namespace

std::string metrics_text(const std::string& bench, const DeskView& view,
                         const ControlTotals& control) {
  Exposition out;
  out.single("up", "1 while the daemon serves", 1.0);
  out.gauge("build_info", "1, with the version");
  out.sample("version", FOGBENCH_VERSION, 1.0);
  out.gauge("bench_info", "1, with the bench's name");
  out.sample("bench", bench, 1.0);
  out.single("start_time_seconds", "When the daemon began to serve, Unix time",
             control.started_unix_s);
  out.gauge("state", "1 for the state that the bench is in");
  for (const std::string_view state : {"idle", "starting", "running", "paused", "stopping"}) {
    out.sample("state", state, state == state_of(view) ? 1.0 : 0.0);
  }
  out.single("queue_jobs", "Runs that wait", static_cast<double>(view.jobs));
  out.single("queue_held", "Whether the queue waits for a person", view.held() ? 1.0 : 0.0);
  out.single("prompt_waiting", "Whether the run waits for an answer", view.question ? 1.0 : 0.0);
  if (view.run) add_present_run(out, *view.run);
  if (view.run && view.values) add_values(out, *view.values);
  if (view.last_run) add_last_run(out, *view.last_run, view.totals.runs);
  out.counts("runs_total", "Runs that ended, by outcome", "outcome", view.totals.runs);
  out.counts("events_total", "Events of runs, by severity", "severity", view.totals.events);
  const drivers::StreamStatistics& stream = view.totals.stream;
  out.counts("gyro_frames_total", "Frames of the gyro, by what became of them", "result",
             {{"good", stream.frames_good},
              {"bad_checksum", stream.frames_bad_checksum},
              {"invalid", stream.frames_invalid},
              {"repeated", stream.frames_repeated},
              {"missing", stream.frames_missing}});
  out.single("control_connections", "Clients of the control socket",
             static_cast<double>(control.connections));
  out.counter("control_connections_refused_total", "Clients that were one too many");
  out.sample(static_cast<double>(control.connections_refused));
  out.counts("control_requests_total", "Requests, by method", "method", control.requests);
  out.counts("control_refusals_total", "Requests answered with an error, by its code", "code",
             control.refusals);
  return std::move(out).text();
}

Result<std::unique_ptr<MetricsFile>> MetricsFile::open(const std::filesystem::path& path,
                                                       drivers::Clock& clock) {
  if (!path.empty()) {
    if (const Status ok = config::write_file(path, ""); !ok) return ok.error();
  }
  return std::unique_ptr<MetricsFile>(new MetricsFile(path, clock));
}

MetricsFile::~MetricsFile() {
  std::error_code ignored;
  if (!path_.empty()) std::filesystem::remove(path_, ignored);
}

void MetricsFile::update(const std::function<std::string()>& text) {
  const auto now = clock_.now();
  if (path_.empty() || now < due_) return;
  due_ = now + kEvery;
  const Status written = config::write_file(path_, text());
  if (!written && !failing_) spdlog::warn("metrics: {}", written.error().message);
  if (written && failing_) spdlog::info("metrics: {}: written again", path_.string());
  failing_ = !written;
}

}  // namespace fogbench::daemon
