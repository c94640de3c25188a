// fogbench procedure: procedures as data. `check` says everything that is wrong in one.

#include "config/procedure.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/common_options.hpp"
#include "cli/output.hpp"
#include "config/paths.hpp"
#include "daemon/session.hpp"
#include "procedures/phases.hpp"

namespace fogbench::cli {
namespace {

struct CheckProcedureOptions {
  ProcedureOptions procedure;
  bool json = false;
};

/// The file, and where nothing is wrong in it what it would do on that bench.
Result<std::vector<Error>> problems_of(const CheckProcedureOptions& options,
                                       const config::BenchConfig& bench) {
  const auto parameters = parse_parameters(options.procedure.set);
  if (!parameters) return parameters.error();
  const auto file = config::find_config("procedures", options.procedure.procedure);
  if (!file) return file.error();
  config::ProcedureConfig procedure;
  auto problems = config::check_procedure_file(*file, procedure);
  if (!problems.empty()) return problems;
  return procedures::check_procedure(procedure, bench, *parameters);
}

Result<ExitStatus> run_check_procedure(const CheckProcedureOptions& options) {
  const auto setup = daemon::load_setup({.bench = options.procedure.bench});
  if (!setup) return setup.error();
  const auto problems = problems_of(options, setup->bench);
  if (!problems) return problems.error();
  if (options.json) {
    nlohmann::ordered_json document{{"procedure", options.procedure.procedure},
                                    {"bench", setup->bench.name},
                                    {"problems", nlohmann::ordered_json::array()}};
    for (const Error& problem : *problems) document["problems"].push_back(problem.message);
    print_json(document);
  } else {
    for (const Error& problem : *problems) print_error(problem.message);
  }
  if (!problems->empty()) return config::exit_status(problems->front().code);
  if (options.json) return ExitStatus::kDone;
  const auto planned = daemon::plan_procedure(options.procedure.procedure, setup->bench,
                                              *parse_parameters(options.procedure.set));
  if (!planned) return planned.error();
  fmt::print("{}", wrapped(fmt::format("{} can run on bench {}: {}", planned->plan.procedure,
                                       setup->bench.name, procedures::summary_text(planned->plan)),
                           ""));
  return ExitStatus::kDone;
}

}  // namespace

void add_procedure(CLI::App& app, Action& action) {
  CLI::App* procedure = app.add_subcommand("procedure", "Check a procedure of your own");
  procedure->require_subcommand(1);
  add_command<CheckProcedureOptions>(
      *procedure, action, "check",
      "Say everything that is wrong in a procedure, for a bench; touches nothing",
      "  fogbench procedure check my-cycles.json\n"
      "  fogbench procedure check my-cycles.json --bench my-bench.json",
      [](CLI::App& command, CheckProcedureOptions& options) {
        add_procedure_options(command, options.procedure);
        command.add_flag("--json", options.json, "One JSON document on stdout");
      },
      run_check_procedure);
}

}  // namespace fogbench::cli
