#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/control_client.hpp"
#include "cli/output.hpp"
#include "cli/status_text.hpp"

namespace fogbench::cli {
namespace {

struct AbortOptions {
  std::string socket;
  bool force = false;
  bool json = false;
};

/// Waits for what it asked for: whoever aborts wants to know that the bench is safe.
Result<ExitStatus> run_abort(const AbortOptions& options) {
  auto client = ControlClient::connect(options.socket);
  if (!client) return client.error();
  const auto asked = (*client)->call("abort", {{"force", options.force}});
  if (options.force) {
    // The daemon may be gone before it has answered; a refusal leaves it there.
    const auto status = asked ? (*client)->call("status") : asked;
    if (!status && status.error().message.find("is gone") == std::string::npos) {
      return status.error();
    }
    if (options.json) {
      print_json({{"daemon_ended", true}, {"safe_state_reached", false}});
      return ExitStatus::kDone;
    }
    fmt::print("The daemon has ended; the bench is NOT in its safe state until it starts again.\n");
    return ExitStatus::kDone;
  }
  if (!asked) return asked.error();
  const auto watching = (*client)->call("watch", {{"every_s", 0.2}});
  if (!watching) return watching.error();
  while (true) {
    const auto status = (*client)->next_status();
    if (!status) return status.error();
    const auto last = status->find("last_run");
    if (!status->value("run", nlohmann::json()).is_null() || last == status->end()) continue;
    if (!last->value("safe_state_reached", false)) {
      return Error{ErrorCode::kDevice, ended_text(*last)};
    }
    if (options.json) {
      print_json(*last);
    } else {
      fmt::print("{}\n", ended_text(*last));
    }
    return ExitStatus::kDone;
  }
}

}  // namespace

void add_abort(CLI::App& app, Action& action) {
  add_command<AbortOptions>(
      app, action, "abort", "End the daemon's run: the safe state now",
      "  fogbench abort\n"
      "  fogbench abort --force    the daemon itself, at once; only when abort does not help",
      [](CLI::App& command, AbortOptions& options) {
        command.add_flag("--force", options.force,
                         "End the daemon at once and leave the bench as it is");
        command.add_flag("--json", options.json, "One JSON document on stdout: the run that ended");
        add_socket_option(command, options.socket);
      },
      run_abort);
}

}  // namespace fogbench::cli
