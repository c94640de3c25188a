#include <fmt/format.h>

#include "cli/command.hpp"

namespace fogbench::cli {
namespace {

struct RunsOptions {
  std::string store;
};

Result<ExitStatus> run_runs(const RunsOptions&) {
  return Error{ErrorCode::kStore, "no run log yet"};
}

}  // namespace

void add_runs(CLI::App& app, Action& action) {
  add_command<RunsOptions>(
      app, action, "runs", "List the runs of a store", "  fogbench runs\n",
      [](CLI::App& command, RunsOptions& options) {
        command.add_option("--store", options.store, "Store file instead of the default one");
      },
      run_runs);
}

}  // namespace fogbench::cli
