#include "cli/status_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/shell_word.hpp"
#include "config/units.hpp"
#include "procedures/sentence.hpp"

namespace fogbench::cli {
namespace {

using nlohmann::json;

const json& at(const json& object, const char* key) {
  static const json kNone;
  if (!object.is_object()) return kNone;
  const auto found = object.find(key);
  return found == object.end() ? kNone : *found;
}

std::string plain(const json& value) {
  if (value.is_string()) return value.get<std::string>();
  return value.is_null() ? "-" : value.dump();
}

double real(const json& value) {
  return value.is_number() ? value.get<double>() : 0.0;
}

std::string span_text(const json& seconds) {
  return procedures::duration_text(config::Seconds{std::round(real(seconds))});
}

std::string points_text(const json& points) {
  return plain(points) + (points == 1 ? " point" : " points");
}

/// "45 s old"
std::string age_text(const json& age_s) {
  return span_text(age_s) + " old";
}

/// "temperature working 1  21.01 degC", two to a line; what is missing now as it was last. The
/// units of these values have no '_'.
std::string values_text(const json& status) {
  // They come about once a second.
  constexpr double kFreshS = 3.0;
  const json& values = at(status, "values");
  std::string lines, left;
  if (real(at(status, "values_age_s")) > kFreshS) {
    lines = "read last, " + age_text(at(status, "values_age_s")) + ":\n";
  }
  for (const auto& [key, value] : values.items()) {
    if (key == "time_s") continue;
    const std::string_view unit = config::unit_of(key);
    std::string name = unit.empty() ? key : key.substr(0, key.rfind('_'));
    std::replace(name.begin(), name.end(), '_', ' ');
    const json& old = at(at(status, "old_values"), key.c_str());
    const json& known = value.is_null() && old.is_object() ? at(old, "value") : value;
    const std::string shown =
        known.is_number() ? fmt::format("{:.3f}", known.get<double>()) : plain(known);
    const std::string age =
        value.is_null() && old.is_object() ? ", " + age_text(at(old, "age_s")) : "";
    const std::string cell = fmt::format("  {:<22}{:>10} {}{}", name, shown, unit, age);
    if (left.empty()) {
      left = cell;
    } else {
      lines += fmt::format("{:<41}{}\n", left, cell);
      left.clear();
    }
  }
  return left.empty() ? lines : lines + left + '\n';
}

/// Why the queue is held, and how it goes on; empty when it is not.
std::string held_text(const json& queue, const char* before) {
  if (at(queue, "held") != true) return "";
  return fmt::format("{}{} (fogbench resume goes on)", before, plain(at(queue, "because")));
}

}  // namespace

std::string status_text(const json& status) {
  std::string out;
  const json& run = at(status, "run");
  if (run.is_object()) {
    out += fmt::format("{}: run {}, {}{}, asked for by {}\n", plain(at(status, "state")),
                       plain(at(run, "run")), plain(at(run, "procedure")), gyro_text(run),
                       plain(at(run, "by")));
    out += fmt::format("step {} of {}: {}\n", plain(at(run, "step")), plain(at(run, "steps")),
                       plain(at(run, "says")));
    out += fmt::format("{} so far, about {} left, {}\n", span_text(at(run, "elapsed_s")),
                       span_text(at(run, "remaining_s")), points_text(at(run, "points")));
    if (at(run, "abort_requested") == true) {
      out += "an abort has been asked for\n";
    } else if (at(run, "pause_requested") == true && at(status, "state") != "paused") {
      out += at(run, "pauses_after") == true
                 ? "a pause has been asked for: no step is left to hold before, the queue is held "
                   "after the run\n"
                 : "a pause has been asked for: before the next divisible step\n";
    }
    const json& waiting = at(run, "waiting");
    if (waiting.is_object()) {
      out += fmt::format(
          "it has waited for {}; the run fails in {}\n", span_text(at(waiting, "for_s")),
          span_text(
              json(std::max(0.0, real(at(waiting, "at_most_s")) - real(at(waiting, "for_s"))))));
    }
  } else {
    const bool waits = at(status, "state") == "waiting";
    out += fmt::format("{}: {}\n", plain(at(status, "state")),
                       waits ? plain(at(status, "waits_for")) : "nothing is running");
    const json& last = at(status, "last_run");
    if (last.is_object()) {
      out += "last: " + ended_text(last) + "\n";
      if (at(last, "resumable") == true) {
        out += fmt::format("(fogbench resume {} takes it up)\n", plain(at(last, "run")));
      }
    }
  }
  const json& interrupted = at(status, "interrupted");
  if (interrupted.is_object()) {
    const std::string number = plain(at(interrupted, "run"));
    out += fmt::format("run {}, {}{}, was interrupted after {}", number,
                       plain(at(interrupted, "procedure")), gyro_text(interrupted),
                       points_text(at(interrupted, "points")));
    const json& obstacle = at(interrupted, "obstacle");
    out += obstacle.is_string()
               ? fmt::format(
                     "\n{}\nfogbench resume {} --discard gives it up, fogbench run {} "
                     "begins it anew\n",
                     plain(obstacle), number, shell_word(plain(at(interrupted, "procedure"))))
               : fmt::format(
                     ": fogbench resume {} takes it up,\n"
                     "fogbench resume {} --discard gives it up\n",
                     number, number);
  }
  out += queue_text(status);
  const json& prompt = at(status, "prompt");
  if (prompt.is_object()) {
    out += fmt::format("prompt {}: {} (fogbench answer yes|no)\n", plain(at(prompt, "prompt")),
                       plain(at(prompt, "text")));
  }
  if (!run.is_object()) return out;
  if (at(status, "values").is_object()) out += values_text(status);
  // One clock: the record's times are since the gyro's power-on, a person's since the run's start.
  const auto since_start = [&run](const json& time_s) {
    return span_text(json(std::max(0.0, real(time_s) - real(at(run, "started_s")))));
  };
  const json& point = at(status, "point");
  if (point.is_object()) {
    out += fmt::format("last point: {}, {} after the start, {:.4f} deg/h\n",
                       plain(at(point, "segment")), since_start(at(point, "time_s")),
                       real(at(point, "rate_deg_per_h")));
  }
  const json& events = at(status, "events");
  constexpr std::size_t kShown = 5;
  const std::size_t first = events.size() > kShown ? events.size() - kShown : 0;
  for (std::size_t i = first; events.is_array() && i < events.size(); ++i) {
    out += fmt::format("{:>12}  {:<7}  {}\n", since_start(at(events[i], "time_s")),
                       plain(at(events[i], "severity")), plain(at(events[i], "message")));
  }
  return out;
}

std::string queue_text(const json& status) {
  const json& queue = at(status, "queue");
  const bool waiting = real(at(queue, "jobs")) > 0, held = at(queue, "held") == true;
  if (!waiting && !held) return "";
  return fmt::format("{}{}\n",
                     waiting ? plain(at(queue, "jobs")) + " in the queue" : "the queue is",
                     held_text(queue, waiting ? ", held: " : " held: "));
}

std::string gyro_text(const json& job) {
  const json& gyro = at(job, "gyro");
  return gyro.is_string() && gyro != "" ? ", gyro " + plain(gyro) : "";
}

std::string ended_text(const json& ended) {
  return fmt::format(
      "run {}, {}{}: {}, {}, {}; the bench is {}", plain(at(ended, "run")),
      plain(at(ended, "procedure")), gyro_text(ended), plain(at(ended, "outcome")),
      plain(at(ended, "reason")), points_text(at(ended, "points")),
      at(ended, "safe_state_reached") == true ? "in its safe state" : "NOT in its safe state");
}

bool is_at_rest(const json& status) {
  const json& queue = at(status, "queue");
  return !at(status, "run").is_object() &&
         (real(at(queue, "jobs")) == 0 || at(queue, "held") == true ||
          at(status, "stopping") == true);
}

Status outcome_of(const json& ended) {
  const json& outcome = at(ended, "outcome");
  if (outcome == "completed") return {};
  return Error{outcome == "aborted" ? ErrorCode::kAborted : ErrorCode::kDevice, ended_text(ended)};
}

}  // namespace fogbench::cli
