#pragma once
// The seam between main and the commands: one file per command, cli/<command>.cpp, which declares
// its options on a subcommand and leaves what to do once the command line has been read.

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "config/exit_status.hpp"
#include "config/result.hpp"

namespace fogbench::cli {

/// What the chosen command does. An error is printed as one line by main, which maps it to the
/// exit status; a result that is an answer "no" is ExitStatus::kNo.
using Action = std::function<Result<ExitStatus>()>;

/// Adds `name` with the options that `declare` binds to one Options value, and has `run` called
/// with them when the user chose this command. `examples` stand at the end of its --help.
///
///   add_command<FitOptions>(app, action, "fit", "Fit an error model to measurements",
///                           "  fogbench fit 7 --model magnetic -o fitted.json",
///                           [](CLI::App& command, FitOptions& options) {...}, run_fit);
template <class Options, class Declare>
void add_command(CLI::App& app, Action& action, const std::string& name,
                 const std::string& description, const std::string& examples, Declare declare,
                 Result<ExitStatus> (*run)(const Options&)) {
  const auto options = std::make_shared<Options>();  // shared by the parser and the action
  CLI::App* command = app.add_subcommand(name, description);
  command->footer("Examples:\n" + examples);
  declare(*command, *options);
  command->callback([&action, options, run] { action = [options, run] { return run(*options); }; });
}

// The commands, in the order in which --help lists them. Each is defined in its own file.
void add_plan(CLI::App& app, Action& action);
void add_procedure(CLI::App& app, Action& action);
void add_dry_run(CLI::App& app, Action& action);
void add_simulate(CLI::App& app, Action& action);
void add_runs(CLI::App& app, Action& action);
void add_show(CLI::App& app, Action& action);
void add_history(CLI::App& app, Action& action);
void add_export(CLI::App& app, Action& action);
void add_inspect(CLI::App& app, Action& action);
void add_import(CLI::App& app, Action& action);
void add_effects(CLI::App& app, Action& action);
void add_fit(CLI::App& app, Action& action);
void add_add(CLI::App& app, Action& action);
void add_compensate(CLI::App& app, Action& action);
void add_compare(CLI::App& app, Action& action);
void add_diagnose(CLI::App& app, Action& action);
void add_allan(CLI::App& app, Action& action);
void add_verdict(CLI::App& app, Action& action);
void add_passport(CLI::App& app, Action& action);
void add_challenge(CLI::App& app, Action& action);
void add_reveal(CLI::App& app, Action& action);
void add_run(CLI::App& app, Action& action);
void add_status(CLI::App& app, Action& action);
void add_watch(CLI::App& app, Action& action);
void add_pause(CLI::App& app, Action& action);
void add_resume(CLI::App& app, Action& action);
void add_abort(CLI::App& app, Action& action);
void add_answer(CLI::App& app, Action& action);
void add_queue(CLI::App& app, Action& action);
void add_device(CLI::App& app, Action& action);
void add_help(CLI::App& app, Action& action);
/// Of `fogbench device`.
void add_device_probe(CLI::App& device, Action& action);

inline constexpr void (*kCommands[])(CLI::App& app, Action& action) = {
    add_plan,     add_procedure,  add_dry_run, add_simulate, add_runs,    add_show,
    add_history,  add_export,     add_inspect, add_import,   add_effects, add_fit,
    add_add,      add_compensate, add_compare, add_diagnose, add_allan,   add_verdict,
    add_passport, add_challenge,  add_reveal,  add_run,      add_status,  add_watch,
    add_pause,    add_resume,     add_abort,   add_answer,   add_queue,   add_device,
    add_help,
};

}  // namespace fogbench::cli
