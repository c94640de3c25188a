#include "daemon/desk_json.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "config/json_file.hpp"
#include "procedures/channel_values.hpp"
#include "procedures/run_state.hpp"

namespace fogbench::daemon {
namespace {

using nlohmann::ordered_json;

/// Longer ones are cut: an instrument's own words may be any length.
constexpr std::size_t kLongestMessage = 500;

std::string short_text(const std::string& text) {
  return config::one_line(text, kLongestMessage);
}

ordered_json number(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json();
}

ordered_json waiting_of(const procedures::Progress& now) {
  if (!now.waiting) return nullptr;
  return {{"for_s", number(now.waiting->lasted.count())},
          {"at_most_s", number(now.waiting->at_most.count())}};
}

ordered_json to_json(const PresentRun& run) {
  const procedures::Progress& now = run.progress;
  return {{"run", run.run == 0 ? ordered_json() : ordered_json(run.run)},
          {"job", run.job},
          {"procedure", run.procedure},
          {"gyro", run.gyro},
          {"by", run.by},
          {"step", std::min(now.step + 1, now.steps)},
          {"steps", now.steps},
          {"says", short_text(now.says)},
          {"elapsed_s", number(now.elapsed.count())},
          {"remaining_s", number(now.remaining.count())},
          {"points", run.points},
          {"started_s", number(now.started.count())},
          {"waiting", waiting_of(now)},
          {"pause_requested", run.pause_requested},
          {"pauses_after", run.pauses_after},
          {"abort_requested", run.abort_requested}};
}

ordered_json to_json(const EndedRun& run) {
  return {{"run", run.run == 0 ? ordered_json() : ordered_json(run.run)},
          {"job", run.job},
          {"procedure", run.procedure},
          {"gyro", run.gyro},
          {"by", run.by},
          {"outcome", run.outcome},
          {"reason", short_text(run.reason)},
          {"safe_state_reached", run.safe_state_reached},
          {"points", run.points},
          {"resumable", run.resumable}};
}

ordered_json to_json(const InterruptedRun& run) {
  return {
      {"run", run.run},
      {"procedure", run.procedure},
      {"gyro", run.gyro},
      {"by", run.by},
      {"started_at", run.started_at},
      {"points", run.points},
      {"obstacle", run.obstacle.empty() ? ordered_json() : ordered_json(short_text(run.obstacle))}};
}

ordered_json to_json(const procedures::MonitorRow& row) {
  ordered_json values = ordered_json::object();
  procedures::for_each_value(
      row, [&](std::string_view name, double value) { values[std::string(name)] = number(value); });
  values["mode"] = name_of(row.thermostat.mode);
  return values;
}

/// How long ago something was read; null between runs.
ordered_json age_of(double time_s, const DeskView& view) {
  const auto now_s = view.now_s();
  return now_s ? number(std::max(0.0, *now_s - time_s)) : ordered_json();
}

ordered_json old_values(const DeskView& view) {
  ordered_json values = ordered_json::object();
  for (const KnownValue& known : view.known) {
    values[known.name] = {{"value", number(known.value)}, {"age_s", age_of(known.time_s, view)}};
  }
  return values;
}

ordered_json to_json(const procedures::Point& point) {
  return {{"segment", point.segment},
          {"time_s", number(point.time_s)},
          {"rate_deg_per_h", number(point.rate_deg_per_h)},
          {"rate_std_error_deg_per_h", number(point.rate_std_error_deg_per_h)},
          {"temperature_c", number(point.temperature_c)},
          {"field_set_ut", number(point.field_set_ut)}};
}

template <class T>
ordered_json or_null(const std::optional<T>& value) {
  return value ? to_json(*value) : ordered_json();
}

}  // namespace

std::string_view state_of(const DeskView& view) {
  if (!view.bench_waits_for.empty()) return "waiting";
  if (!view.run) return "idle";
  // The instruments are being identified, which is no state of the engine.
  if (view.run->run == 0) return "starting";
  // An end that waits for the run log.
  const procedures::RunState state = view.run->progress.state;
  const bool ended = state == procedures::RunState::kCompleted ||
                     state == procedures::RunState::kAborted ||
                     state == procedures::RunState::kFailed;
  return procedures::name_of(ended ? procedures::RunState::kStopping : state);
}

ordered_json to_json(const DeskView& view) {
  ordered_json question, events = ordered_json::array();
  if (view.question) {
    question = {{"prompt", view.question->prompt}, {"text", short_text(view.question->text)}};
  }
  for (const SeenEvent& event : view.events) {
    events.push_back({{"time_s", number(event.time_s)},
                      {"severity", event.severity},
                      {"message", short_text(event.message)}});
  }
  return {{"protocol", kProtocolVersion},
          {"state", state_of(view)},
          {"stopping", view.closing},
          {"waits_for", short_text(view.bench_waits_for)},
          {"run", or_null(view.run)},
          {"prompt", question},
          {"values", or_null(view.values)},
          {"values_age_s", view.values ? age_of(view.values->time_s, view) : ordered_json()},
          {"old_values", old_values(view)},
          {"point", or_null(view.point)},
          {"events", events},
          {"queue", {{"jobs", view.jobs}, {"held", view.held()}, {"because", view.held_because}}},
          {"last_run", or_null(view.last_run)},
          {"interrupted", or_null(view.interrupted)}};
}

ordered_json to_json(const std::vector<QueuedJob>& queue) {
  ordered_json jobs = ordered_json::array();
  for (const QueuedJob& job : queue) {
    jobs.push_back({{"job", job.job},
                    {"procedure", job.procedure},
                    {"gyro", job.gyro},
                    {"by", job.by},
                    {"estimate_s", number(job.estimate.count())},
                    {"keep_going", job.keep_going}});
  }
  return jobs;
}

ordered_json to_json(const std::vector<EndedRun>& runs) {
  ordered_json list = ordered_json::array();
  for (const EndedRun& run : runs) list.push_back(to_json(run));
  return list;
}

ordered_json filled(const ordered_json& pattern, const ordered_json& document) {
  if (pattern.is_structured()) {
    ordered_json shape = pattern;
    for (auto& member : shape) member = filled(member, document);
    return shape;
  }
  if (!pattern.is_string()) return pattern;
  const auto& text = pattern.get_ref<const std::string&>();
  if (text.empty() || text.front() != '/') return pattern;
  // Walked by hand: the library throws for a pointer that is none.
  const ordered_json* at = &document;
  for (std::size_t begin = 1; begin <= text.size();) {
    const std::size_t end = std::min(text.find('/', begin), text.size());
    const std::string key = text.substr(begin, end - begin);
    if (!at->is_object() || !at->contains(key)) return nullptr;
    at = &at->at(key);
    begin = end + 1;
  }
  return *at;
}

}  // namespace fogbench::daemon
