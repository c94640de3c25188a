#include <fmt/format.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/command.hpp"
#include "cli/control_client.hpp"
#include "cli/output.hpp"
#include "procedures/sentence.hpp"

namespace fogbench::cli {
namespace {

struct QueueOptions {
  std::string socket;
  std::optional<std::uint64_t> remove, move;
  std::uint64_t to = 1;
  bool json = false;
};

Result<ExitStatus> run_queue(const QueueOptions& options) {
  auto client = ControlClient::connect(options.socket);
  if (!client) return client.error();
  if (options.remove) {
    const auto removed = (*client)->call("remove", {{"job", *options.remove}});
    if (!removed) return removed.error();
  }
  if (options.move) {
    const auto moved = (*client)->call("move", {{"job", *options.move}, {"to", options.to}});
    if (!moved) return moved.error();
  }
  const auto queue = (*client)->call("queue");
  if (!queue) return queue.error();
  if (options.json) {
    print_json(*queue);
    return ExitStatus::kDone;
  }
  using Align = TextTable::Align;
  TextTable table({{"job", ""},
                   {"procedure", "", Align::kLeft},
                   {"gyro", "", Align::kLeft},
                   {"asked for by", "", Align::kLeft},
                   {"takes about", "", Align::kLeft},
                   {"after a failed run", "", Align::kLeft}});
  for (const auto& job : queue->value("jobs", nlohmann::json::array())) {
    table.add_row({std::to_string(job.value("job", 0)), job.value("procedure", ""),
                   job.value("gyro", ""), job.value("by", ""),
                   procedures::duration_text(config::Seconds{job.value("estimate_s", 0.0)}),
                   job.value("keep_going", false) ? "runs too" : "waits"});
  }
  fmt::print("{}", table.empty() ? "The queue is empty.\n" : table.text());
  if (queue->value("held", false)) {
    fmt::print("Held: {}. fogbench resume goes on.\n", queue->value("because", ""));
  }
  return ExitStatus::kDone;
}

}  // namespace

void add_queue(CLI::App& app, Action& action) {
  add_command<QueueOptions>(
      app, action, "queue", "List what waits to be run on the daemon's bench",
      "  fogbench queue\n"
      "  fogbench queue --remove 4\n"
      "  fogbench queue --move 7 --to 1    runs it next\n"
      "fogbench pause --after-run holds it, fogbench resume goes on with it.",
      [](CLI::App& command, QueueOptions& options) {
        command.add_option("--remove", options.remove, "Take this job out of the queue first");
        CLI::Option* move =
            command.add_option("--move", options.move, "Give this job another place first");
        command.add_option("--to", options.to, "The place: 1 is the next to run (default: 1)")
            ->needs(move);
        add_socket_option(command, options.socket);
        command.add_flag("--json", options.json, "One JSON document on stdout");
      },
      run_queue);
}

}  // namespace fogbench::cli
