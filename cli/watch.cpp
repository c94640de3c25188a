#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "cli/command.hpp"
#include "cli/control_client.hpp"
#include "cli/output.hpp"
#include "cli/status_text.hpp"

namespace fogbench::cli {
namespace {

struct WatchOptions {
  std::string socket;
  double every_s = 1.0;
  bool json = false;
};

bool at_terminal() {
  return isatty(STDOUT_FILENO) == 1;
}

/// A page that overwrites itself; nothing when stdout is no terminal.
class Page {
 public:
  void show(const std::string& text) {
    if (!wanted_) return;
    clear();
    fmt::print("{}", text);
    std::fflush(stdout);
    lines_ = std::count(text.begin(), text.end(), '\n');
  }
  void clear() {
    if (lines_ > 0) fmt::print("\033[{}A\033[J", lines_);
    lines_ = 0;
  }

 private:
  bool wanted_ = at_terminal();
  std::ptrdiff_t lines_ = 0;
};

Result<ExitStatus> run_watch(const WatchOptions& options) {
  auto client = ControlClient::connect(options.socket);
  if (!client) return client.error();
  const auto watching = (*client)->call("watch", {{"every_s", options.every_s}});
  if (!watching) return watching.error();
  Page page;
  bool any_run = false;
  while (true) {
    const auto status = (*client)->next_status();
    if (!status) {
      page.clear();
      return status.error();
    }
    if (options.json) {
      fmt::print("{}\n", status->dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
      if (std::fflush(stdout) != 0) return ExitStatus::kDone;  // main says what is wrong
    } else {
      page.show(status_text(*status));
    }
    if (!is_at_rest(*status)) {
      any_run = true;
      continue;
    }
    page.clear();
    const auto last = status->find("last_run");
    const bool ended = last != status->end() && last->is_object();
    const Status outcome = ended ? outcome_of(*last) : Status{};
    if (!any_run && !options.json) fmt::print("{}", status_text(*status));
    if (!outcome) return outcome.error();
    if (any_run && ended && !options.json) {
      fmt::print("{}\n{}", ended_text(*last), queue_text(*status));
      const std::int64_t run = last->value("run", std::int64_t{0});
      if (at_terminal() && run > 0 && last->value("points", 0) > 0) {
        fmt::print("Next: fogbench verdict {0}\n      fogbench passport {0} -o passport-{0}.html\n",
                   run);
      }
    }
    return ExitStatus::kDone;
  }
}

}  // namespace

void add_watch(CLI::App& app, Action& action) {
  add_command<WatchOptions>(
      app, action, "watch", "Follow the daemon's bench until nothing is left to run",
      "  fogbench watch\n"
      "  fogbench watch --json --every 10 >> night.jsonl\n"
      "Shows progress, time left, values and events on a terminal; elsewhere only how it ended.\n"
      "Exit status 4 when the last run did not complete.",
      [](CLI::App& command, WatchOptions& options) {
        command.add_option("--every", options.every_s, "Seconds between two looks (default: 1)")
            ->check(CLI::Range(0.1, 3600.0));
        add_socket_option(command, options.socket);
        command.add_flag("--json", options.json, "One JSON document a line on stdout");
      },
      run_watch);
}

}  // namespace fogbench::cli
