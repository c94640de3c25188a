#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>
#include <variant>

#include "cli/command.hpp"
#include "cli/common_options.hpp"
#include "cli/control_client.hpp"
#include "cli/output.hpp"
#include "cli/status_text.hpp"
#include "daemon/run_options.hpp"
#include "drivers/clock.hpp"
#include "procedures/sentence.hpp"

namespace fogbench::cli {
namespace {

struct RunOptions {
  std::string procedure, gyro, gyro_on_since, socket;
  std::vector<std::string> set;
  bool keep_going = false, json = false;
};

Result<ExitStatus> run_run(const RunOptions& options) {
  const auto parameters = parse_parameters(options.set);
  if (!parameters) return parameters.error();
  nlohmann::ordered_json set = nlohmann::ordered_json::object();
  for (const auto& [name, value] : *parameters) {
    std::visit([&set, &key = name](const auto& v) { set[key] = v; }, value);
  }
  // The daemon works in another folder.
  std::string procedure = options.procedure;
  std::error_code error;
  if (std::filesystem::is_regular_file(procedure, error)) {
    procedure = std::filesystem::absolute(procedure, error).string();
  }
  auto client = ControlClient::connect(options.socket);
  if (!client) return client.error();
  nlohmann::ordered_json params{{"procedure", procedure}, {"set", set}};
  if (!options.gyro.empty()) params["gyro"] = options.gyro;
  if (options.keep_going) params["keep_going"] = true;
  if (!options.gyro_on_since.empty()) {
    const auto since = parse_moment("--gyro-on-since", options.gyro_on_since);
    if (!since) return since.error();
    params["gyro_on_since"] = drivers::utc_text(*since);
  }
  const auto queued = (*client)->call("run", params);
  if (!queued) return queued.error();
  if (options.json) {
    print_json(*queued);
    return ExitStatus::kDone;
  }
  fmt::print("Job {}, {}{}: {} steps, about {}\n", queued->value("job", 0), options.procedure,
             gyro_text(*queued), queued->value("steps", 0),
             procedures::duration_text(config::Seconds{queued->value("estimate_s", 0.0)}));
  const bool held = queued->value("held", false);
  if (held) fmt::print("The queue is held: {}\n", queued->value("because", ""));
  fmt::print("Next: fogbench {}{}\n", held ? "resume" : "watch", socket_argument(options.socket));
  return ExitStatus::kDone;
}

}  // namespace

void add_run(CLI::App& app, Action& action) {
  add_command<RunOptions>(
      app, action, "run", "Queue a procedure on the daemon's bench",
      "  fogbench run acceptance\n"
      "  fogbench run ./my-sweep.json --set average_s=60 --gyro FOG-42\n"
      "  fogbench run coil-sweep --keep-going    though the run before it may fail",
      [](CLI::App& command, RunOptions& options) {
        command
            .add_option("PROCEDURE", options.procedure,
                        "A procedure file that the daemon may read, or a ready one")
            ->required();
        command
            .add_option("--set", options.set,
                        "name=value or name=value,value...: a parameter of the procedure")
            ->allow_extra_args(false);
        daemon::add_gyro_option(command, options.gyro, "the daemon's, else the bench file's");
        add_gyro_on_since_option(command, options.gyro_on_since);
        command.add_flag("--keep-going", options.keep_going,
                         "Run it also when the run before it has failed, the bench being safe");
        add_socket_option(command, options.socket);
        command.add_flag("--json", options.json, "One JSON document on stdout");
      },
      run_run);
}

}  // namespace fogbench::cli
