#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/control_client.hpp"
#include "cli/output.hpp"
#include "cli/status_text.hpp"

namespace fogbench::cli {
namespace {

struct StatusOptions {
  std::string socket;
  bool json = false;
};

Result<ExitStatus> run_status(const StatusOptions& options) {
  auto client = ControlClient::connect(options.socket);
  if (!client) return client.error();
  const auto status = (*client)->call("status");
  if (!status) return status.error();
  if (options.json) {
    print_json(*status);
  } else {
    fmt::print("{}", status_text(*status));
  }
  return ExitStatus::kDone;
}

}  // namespace

void add_status(CLI::App& app, Action& action) {
  add_command<StatusOptions>(
      app, action, "status", "Say what the daemon's bench is doing now",
      "  fogbench status\n  fogbench status --json",
      [](CLI::App& command, StatusOptions& options) {
        add_socket_option(command, options.socket);
        command.add_flag("--json", options.json, "One JSON document on stdout");
      },
      run_status);
}

}  // namespace fogbench::cli
