// pause and resume: the ladder's first rung and the way back, and the way back from a crash.

#include <fmt/format.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/command.hpp"
#include "cli/control_client.hpp"
#include "cli/status_text.hpp"
#include "procedures/estimate.hpp"

namespace fogbench::cli {
namespace {

struct PauseOptions {
  std::string socket;
};

Result<ExitStatus> ask_daemon(const PauseOptions& options, const char* method, const char* says) {
  auto client = ControlClient::connect(options.socket);
  if (!client) return client.error();
  const auto done = (*client)->call(method);
  if (!done) return done.error();
  fmt::print("{}\n", says);
  return ExitStatus::kDone;
}

struct ResumeOptions {
  std::string socket;
  std::optional<std::uint64_t> run;
  bool discard = false;
};

Result<ExitStatus> run_resume(const ResumeOptions& options) {
  if (!options.run) return ask_daemon({options.socket}, "resume", "Resumed.");
  auto client = ControlClient::connect(options.socket);
  if (!client) return client.error();
  const auto done =
      (*client)->call(options.discard ? "discard" : "resume", {{"run", *options.run}});
  if (!done) return done.error();
  if (options.discard) {
    fmt::print("Run {} is given up; what it measured stays in the run log.\n", *options.run);
    return ExitStatus::kDone;
  }
  fmt::print("Job {} takes up run {}{}: {} steps, about {}\nNext: fogbench watch\n",
             done->value("job", 0), *options.run, gyro_text(*done), done->value("steps", 0),
             procedures::duration_text(config::Seconds{done->value("estimate_s", 0.0)}));
  return ExitStatus::kDone;
}

void declare_socket(CLI::App& command, PauseOptions& options) {
  add_socket_option(command, options.socket);
}

}  // namespace

void add_pause(CLI::App& app, Action& action) {
  add_command<PauseOptions>(
      app, action, "pause", "Hold the daemon's run before its next divisible step",
      "  fogbench pause\n"
      "The bench keeps its temperature and field meanwhile. A sweep is finished first.",
      declare_socket, [](const PauseOptions& options) {
        return ask_daemon(options, "pause", "The run pauses before its next divisible step.");
      });
}

void add_resume(CLI::App& app, Action& action) {
  add_command<ResumeOptions>(
      app, action, "resume", "Go on with a paused run, a held queue, or a run that was interrupted",
      "  fogbench resume\n"
      "  fogbench resume 7\n"
      "  fogbench resume 7 --discard\n"
      "With a number: after a crash, a power cut, a fault or an abort. Gyro and bench are brought "
      "back\n"
      "to where they were, the interrupted point, sweep or heating is measured anew, and the gap "
      "is\n"
      "on record. You confirm with it that the gyro is still in its place.",
      [](CLI::App& command, ResumeOptions& options) {
        CLI::Option* run =
            command.add_option("RUN", options.run, "The number of a run that was not completed");
        command.add_flag("--discard", options.discard, "Give the interrupted run up instead")
            ->needs(run);
        add_socket_option(command, options.socket);
      },
      run_resume);
}

}  // namespace fogbench::cli
