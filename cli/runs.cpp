#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/common_options.hpp"
#include "cli/output.hpp"
#include "record/run_log_reader.hpp"

namespace fogbench::cli {
namespace {

struct RunsOptions {
  std::string store;
  bool json = false;
};

nlohmann::ordered_json row_of(const record::StoredRun& run) {
  return {{"run", run.run},
          {"started_at", run.header.started_at},
          {"procedure", run.header.procedure},
          {"gyro_serial_number", run.header.gyro_serial_number},
          {"bench", run.header.bench},
          {"seed",
           run.header.seed ? nlohmann::ordered_json(*run.header.seed) : nlohmann::ordered_json()},
          {"outcome", run.outcome()},
          {"points", run.points},
          {"points_void", run.points_void}};
}

Result<ExitStatus> run_runs(const RunsOptions& options) {
  const auto path = store_to_read(options.store);
  if (!path) return path.error();
  auto reader = record::RunLogReader::open(*path);
  if (!reader) return reader.error();
  const auto runs = (*reader)->runs();
  if (!runs) return runs.error();

  if (options.json) {
    nlohmann::ordered_json document{{"store", path->string()},
                                    {"runs", nlohmann::ordered_json::array()}};
    for (const auto& run : *runs) document["runs"].push_back(row_of(run));
    print_json(document);
    return ExitStatus::kDone;
  }
  using Align = TextTable::Align;
  TextTable table({{"run", ""},
                   {"started, UTC", "", Align::kLeft},
                   {"procedure", "", Align::kLeft},
                   {"gyro", "", Align::kLeft},
                   {"bench", "", Align::kLeft},
                   {"seed", ""},
                   {"points", ""},
                   {"outcome", "", Align::kLeft}});
  for (const auto& run : *runs) {
    table.add_row({std::to_string(run.run), run.header.started_at, run.header.procedure,
                   run.header.gyro_serial_number, run.header.bench,
                   run.header.seed ? std::to_string(*run.header.seed) : "-",
                   std::to_string(run.points), run.outcome()});
  }
  fmt::print("{}", table.empty() ? "No runs yet.\n" : table.text());
  return ExitStatus::kDone;
}

}  // namespace

void add_runs(CLI::App& app, Action& action) {
  add_command<RunsOptions>(
      app, action, "runs", "List the runs of a run log",
      "  fogbench runs\n  fogbench runs --store bench-2.db --json",
      [](CLI::App& command, RunsOptions& options) {
        add_store_option(command, options.store);
        command.add_flag("--json", options.json, "One JSON document on stdout");
      },
      run_runs);
}

}  // namespace fogbench::cli
