#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/common_options.hpp"
#include "cli/output.hpp"
#include "cli/run_report.hpp"

namespace fogbench::cli {
namespace {

struct ShowOptions {
  std::int64_t run = 0;
  std::string store;
  bool json = false;
};

Result<ExitStatus> run_show(const ShowOptions& options) {
  const auto path = store_to_read(options.store);
  if (!path) return path.error();
  auto reader = record::RunLogReader::open(*path);
  if (!reader) return reader.error();
  if (options.json) {
    const auto document = run_json(**reader, options.run);
    if (!document) return document.error();
    print_json(*document);
  } else {
    const auto text = run_text(**reader, options.run);
    if (!text) return text.error();
    fmt::print("{}", *text);
  }
  return ExitStatus::kDone;
}

}  // namespace

void add_show(CLI::App& app, Action& action) {
  add_command<ShowOptions>(
      app, action, "show", "Show one run: what made it, its results and what happened",
      "  fogbench show 7\n  fogbench show 7 --json | jq .results.sweeps",
      [](CLI::App& command, ShowOptions& options) {
        add_run_option(command, options.run);
        add_store_option(command, options.store);
        command.add_flag("--json", options.json, "One JSON document on stdout");
      },
      run_show);
}

}  // namespace fogbench::cli
