// pause and resume: the ladder's first rung and the way back, and the way back from a crash.

#include <fmt/format.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/command.hpp"
#include "cli/common_options.hpp"
#include "cli/control_client.hpp"
#include "cli/output.hpp"
#include "cli/status_text.hpp"
#include "drivers/clock.hpp"
#include "procedures/sentence.hpp"

namespace fogbench::cli {
namespace {

struct PauseOptions {
  std::string socket;
  bool after_run = false;
  bool json = false;
};

Result<ExitStatus> run_pause(const PauseOptions& options) {
  auto client = ControlClient::connect(options.socket);
  if (!client) return client.error();
  const auto done = (*client)->call(options.after_run ? "hold" : "pause");
  if (!done) return done.error();
  if (options.json) {
    // Where no step is left to hold before, a pause is one after the run.
    print_json(
        {{"pauses", options.after_run || done->value("after_run", false) ? "after_run"
                                                                         : "before_next_step"}});
  } else if (options.after_run) {
    fmt::print("No run begins until fogbench resume; one that is under way goes on to its end.\n");
  } else if (done->value("after_run", false)) {
    fmt::print(
        "No step is left to hold before: the run goes on to its end, then the queue is held.\n");
  } else {
    fmt::print("The run pauses before its next divisible step.\n");
  }
  return ExitStatus::kDone;
}

struct ResumeOptions {
  std::string socket, gyro_on_since;
  std::optional<std::uint64_t> run;
  bool discard = false;
  bool json = false;
};

Result<ExitStatus> run_resume(const ResumeOptions& options) {
  auto client = ControlClient::connect(options.socket);
  if (!client) return client.error();
  nlohmann::ordered_json params = nlohmann::ordered_json::object();
  if (!options.gyro_on_since.empty()) {
    const auto since = parse_moment("--gyro-on-since", options.gyro_on_since);
    if (!since) return since.error();
    params["gyro_on_since"] = drivers::utc_text(*since);
  }
  if (!options.run) {
    const auto resumed = (*client)->call("resume", params);
    if (!resumed) return resumed.error();
    if (options.json) {
      print_json({{"resumed", true}});
    } else {
      fmt::print("Resumed.\n");
    }
    return ExitStatus::kDone;
  }
  params["run"] = *options.run;
  const auto done = (*client)->call(options.discard ? "discard" : "resume", params);
  if (!done) return done.error();
  if (options.json) {
    nlohmann::ordered_json out{{options.discard ? "discarded" : "takes_up", *options.run}};
    if (!options.discard) out.update(*done);
    print_json(out);
    return ExitStatus::kDone;
  }
  if (options.discard) {
    fmt::print("Run {} is given up; what it measured stays in the run log.\n", *options.run);
    return ExitStatus::kDone;
  }
  fmt::print("Job {} takes up run {}{}: {} steps, about {}\nNext: fogbench watch{}\n",
             done->value("job", 0), *options.run, gyro_text(*done), done->value("steps", 0),
             procedures::duration_text(config::Seconds{done->value("estimate_s", 0.0)}),
             socket_argument(options.socket));
  return ExitStatus::kDone;
}

}  // namespace

void add_pause(CLI::App& app, Action& action) {
  add_command<PauseOptions>(
      app, action, "pause", "Hold the daemon's run before its next divisible step",
      "  fogbench pause\n"
      "  fogbench pause --after-run    this run to its end, and no other\n"
      "The bench keeps its temperature and field meanwhile. A sweep is finished first; when it is\n"
      "the last step, the queue is held after the run.",
      [](CLI::App& command, PauseOptions& options) {
        command.add_flag("--after-run", options.after_run,
                         "Let the run go on to its end, and hold the queue then");
        command.add_flag("--json", options.json, "One JSON document on stdout");
        add_socket_option(command, options.socket);
      },
      run_pause);
}

void add_resume(CLI::App& app, Action& action) {
  add_command<ResumeOptions>(
      app, action, "resume", "Go on with a paused run, a held queue, or a run that was interrupted",
      "  fogbench resume\n"
      "  fogbench resume --gyro-on-since 20min    the gyro that was put on for the next job\n"
      "  fogbench resume 7\n"
      "  fogbench resume 7 --discard\n"
      "With a number: after a crash, a power cut, a fault or an abort. Gyro and bench are brought "
      "back\n"
      "to where they were, the interrupted point, sweep or heating is measured anew, and the gap "
      "is\n"
      "on record. You confirm with it that the gyro is still in its place.",
      [](CLI::App& command, ResumeOptions& options) {
        CLI::Option* run =
            command.add_option("RUN", options.run, "The number of a run that was not completed")
                ->check(wrong_run_number);
        CLI::Option* since = add_gyro_on_since_option(command, options.gyro_on_since);
        command.add_flag("--discard", options.discard, "Give the interrupted run up instead")
            ->needs(run)
            ->excludes(since);
        command.add_flag("--json", options.json, "One JSON document on stdout");
        add_socket_option(command, options.socket);
      },
      run_resume);
}

}  // namespace fogbench::cli
