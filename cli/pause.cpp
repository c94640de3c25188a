// pause and resume: the ladder's first rung and the way back.

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/control_client.hpp"

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
  add_command<PauseOptions>(
      app, action, "resume", "Go on with a paused run, or with a queue that is held",
      "  fogbench resume", declare_socket,
      [](const PauseOptions& options) { return ask_daemon(options, "resume", "Resumed."); });
}

}  // namespace fogbench::cli
