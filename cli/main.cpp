// fogbench: the command line. Each command is one file; this one reads the command line, runs the
// command that it names and turns an error into one line and an exit status.

#include <fmt/format.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <cstdio>
#include <exception>
#include <system_error>

#include "cli/command.hpp"
#include "cli/common_options.hpp"
#include "cli/completion_words.hpp"
#include "cli/output.hpp"
#include "daemon/manual.hpp"
#include "daemon/mistyped.hpp"
#include "model/fit/heap.hpp"

namespace {

constexpr auto kDescription =
    "fogbench - acceptance tests of fiber-optic gyros in thermal and magnetic fields, and the\n"
    "error model that goes with them. Results go to stdout, progress and messages to stderr.\n";

constexpr auto kFooter =
    "Exit status: 0 done, 1 the answer is no, 2 usage, 3 bad input, 4 bench, daemon or run log "
    "failed.\n"
    "`fogbench COMMAND --help` shows a command's options and examples, `fogbench help "
    "expressions`\n"
    "how a formula of your own is written.";

fogbench::daemon::ManualText manual_text() {
  return {
      1,
      "acceptance tests of fiber-optic gyros, and their error model",
      "Plans and rehearses acceptance procedures on a simulated bench, reads what was measured, "
      "fits error models to it, compares and diagnoses; and tells a fogbenchd that owns a bench "
      "what to run. Results go to standard output, progress and messages to standard error.",
      {{"FOGBENCH_STORE", "The run log to use, unless --store is given."},
       {"FOGBENCH_SOCKET", "The daemon's control socket, unless --socket is given."},
       {"FOGBENCH_LOCKS", "Where the locks on instruments are, as for fogbenchd(8)."},
       {"FOGBENCH_CONFIG_DIR", "Where the ready files are, instead of beside the program."}},
      {{"~/.local/state/fogbench/fogbench.db", "The user's run log."},
       {"/var/lib/fogbench/fogbench.db", "The service's run log, for the group fogbench."},
       {"/run/fogbench/control.sock", "The service's control socket."},
       {"/usr/share/fogbench/config", "The ready benches, procedures, models and scenarios."},
       {"/usr/share/doc/fogbench", "The formats of the configuration and of the run log."}},
      "fogbenchd(8)"};
}

int cannot_print() {
  fogbench::cli::print_error("the results could not be written to standard output");
  return static_cast<int>(fogbench::ExitStatus::kFailed);
}

int run(int argc, char** argv) {
  using fogbench::ExitStatus;
  CLI::App app{kDescription, "fogbench"};
  app.footer(kFooter);
  app.set_version_flag("--version", "fogbench " FOGBENCH_VERSION);
  fogbench::cli::Action action;
  for (const auto add : fogbench::cli::kCommands) add(app, action);
  fogbench::daemon::add_manual_options(app);
  if (const auto manual = fogbench::daemon::asked_manual(argc, argv, app, manual_text())) {
    if (std::fputs(manual->c_str(), stdout) < 0 || std::fflush(stdout) != 0) return cannot_print();
    return static_cast<int>(ExitStatus::kDone);
  }

  const auto arguments = fogbench::cli::arguments_with_lists(argc, argv);
  if (const auto words = fogbench::cli::asked_words(app, arguments)) {
    for (const std::string& word : *words) fmt::print("{}\n", word);
    return static_cast<int>(ExitStatus::kDone);
  }
  try {
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));  // as CLI11 wants it
  } catch (const CLI::Success& help) {                                          // --help, --version
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    fogbench::cli::print_error(fogbench::daemon::mistyped(app, arguments, error));
    return static_cast<int>(ExitStatus::kUsage);
  }

  if (!action) {
    fogbench::cli::print_error("a command is expected; fogbench --help lists them");
    return static_cast<int>(ExitStatus::kUsage);
  }
  const auto status = action();
  if (!status) {
    fogbench::cli::print_error(status.error().message);
    return static_cast<int>(fogbench::config::exit_status(status.error().code));
  }
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) return cannot_print();
  fogbench::cli::print_notes_beside_result();
  return static_cast<int>(*status);
}

}  // namespace

// Nothing of ours throws; what a library may still throw ends as one line.
int main(int argc, char** argv) {
  fogbench::model::keep_freed_memory();
  // Standard output is for results.
  spdlog::set_default_logger(spdlog::stderr_logger_mt("fogbench"));
  spdlog::set_pattern("fogbench: %v");
  try {
    return run(argc, argv);
  } catch (const std::system_error&) {  // fmt::print, when the disk is full
    return cannot_print();
  } catch (const std::exception& error) {  // memory, above all
    fogbench::cli::print_error(error.what());
    return static_cast<int>(fogbench::ExitStatus::kFailed);
  }
}
