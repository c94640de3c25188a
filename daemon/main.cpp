// fogbenchd: owns a bench, simulated or real. Without a procedure it serves the control socket and
// runs what is queued there; with procedures it runs them in the foreground, one after the other,
// and ends. SIGTERM and SIGINT abort to the safe state.

#include <fmt/format.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <string>
#include <vector>

#include "config/exit_status.hpp"
#include "daemon/abort_on_signal.hpp"
#include "daemon/access.hpp"
#include "daemon/manual.hpp"
#include "daemon/mistyped.hpp"
#include "daemon/run_options.hpp"
#include "daemon/serve.hpp"
#include "daemon/session.hpp"
#include "daemon/simulated_operator.hpp"
#include "daemon/terminal_operator.hpp"
#include "record/store.hpp"

namespace fogbench::daemon {
namespace {

ManualText manual_text() {
  return {
      8,
      "owns a bench of fiber-optic gyros, and runs procedures on it",
      "Without a procedure it serves the control socket: it brings the bench to its safe state "
      "and runs what operators queue with fogbench run. With procedures it runs them in the "
      "foreground, one after the other, and ends. One SIGTERM, SIGINT or SIGHUP aborts the run "
      "to the safe state and ends the daemon; another one, 3 s later or more, ends it at once: 0 A "
      "is sent to the coils then, and nobody waits for it. While an instrument is missing a "
      "serving daemon switches off what it can reach and goes on trying; in the foreground it "
      "tries three times, then ends. As the service fogbenchd.service it is configured in "
      "/etc/default/fogbenchd.",
      {{"FOGBENCH_STORE", "The run log to write, unless --store is given."},
       {"FOGBENCH_SOCKET", "The control socket to serve, unless --socket is given."},
       {"FOGBENCH_LOCKS",
        "Where the locks on instruments are, for all who share the bench, instead of /run/lock."},
       {"FOGBENCH_CONFIG_DIR", "Where the ready files are, instead of beside the program."},
       {"NOTIFY_SOCKET, WATCHDOG_USEC, LISTEN_FDS, RUNTIME_DIRECTORY",
        "As systemd sets them: readiness, watchdog, socket activation, place of the socket."}},
      {{"/etc/default/fogbenchd", "Bench and options of the service."},
       {"/run/fogbench/control.sock", "The service's control socket."},
       {"/run/fogbench/fogbench.prom", "Its metrics, for node_exporter's textfile collector."},
       {"/var/lib/fogbench/fogbench.db", "Its run log."},
       {"/usr/share/fogbench/config", "The ready benches, procedures, models and scenarios."},
       {"/usr/share/doc/fogbench", "The protocol of the socket, the run log's tables."}},
      "fogbench(1)"};
}

struct DaemonOptions {
  SetupOptions setup;
  std::optional<std::uint64_t> seed;
  std::string store, gyro;
  Speed speed = Speed::kRealtime;
  ServeOptions serve;
  std::vector<std::string> procedures;
};

void declare(CLI::App& app, DaemonOptions& options) {
  app.set_version_flag("--version", "fogbenchd " FOGBENCH_VERSION);
  add_manual_options(app);
  CLI::Option* procedures = app.add_option(
      "PROCEDURE", options.procedures,
      "Procedure files, or ready ones, in their order (default: those that operators queue)");
  app.add_option("--bench", options.setup.bench, "A bench file, or a ready one")->required();
  app.add_option("--store", options.store, "Run log to write (default: $FOGBENCH_STORE...)");
  app.add_option("--scenario", options.setup.scenario,
                 "What the simulated gyro hides (default: clean)");
  add_gyro_option(app, options.gyro);
  add_seed_option(app, options.seed);
  add_speed_option(app, options.speed, "realtime");
  app.add_option("--socket", options.serve.socket,
                 "Control socket to serve (default: /run/fogbench/control.sock as root, else "
                 "$XDG_RUNTIME_DIR/fogbench/control.sock)")
      ->excludes(procedures);
  app.add_option("--operators", options.serve.operators, "Group whose members may act")
      ->excludes(procedures);
  app.add_option("--observers", options.serve.observers,
                 "Group whose members may look (default: everybody, when --operators is given)")
      ->excludes(procedures);
  app.add_option("--metrics", options.serve.metrics,
                 "Metrics for Prometheus, written to this file every 10 s")
      ->excludes(procedures);
  app.footer(
      "A bench whose instruments have connections is reached through them; a prompt is answered "
      "on\n"
      "standard input, or over the control socket when no procedure is named.\n"
      "Examples:\n  fogbenchd --bench bench.json --operators fogbench\n"
      "  fogbenchd --bench simulated --speed max thermostat-steps coil-sweep\n"
      "  fogbenchd --bench bench.json coil-sweep\n"
      "Exit status: 0 done, 2 usage, 3 bad input, 4 bench or run log failed.");
}

/// Makes the setup one of a real bench where that is what the file describes.
Status choose_bench(const DaemonOptions& options, Setup& setup) {
  const auto simulated = is_simulated(setup.bench);
  if (!simulated) return simulated.error();
  setup.simulated = *simulated;
  if (setup.simulated) return {};
  if (options.speed != Speed::kRealtime || options.seed ||
      options.setup.scenario != SetupOptions{}.scenario) {
    return Error{ErrorCode::kUsage,
                 fmt::format("--scenario, --seed and --speed are for the simulated bench; bench "
                             "{} is a real one",
                             setup.bench.name)};
  }
  setup.scenario_json.clear();
  return {};
}

/// Everything is read, checked and planned before the bench is touched.
Status run(const DaemonOptions& options) {
  auto setup = load_setup(options.setup);
  if (!setup) return setup.error();
  if (const Status chosen = choose_bench(options, *setup); !chosen) return chosen;
  if (!options.gyro.empty()) setup->bench.gyro.serial_number = options.gyro;
  std::vector<PlannedProcedure> planned;
  for (const std::string& name : options.procedures) {
    auto procedure = plan_procedure(name, setup->bench, {});
    if (!procedure) return procedure.error();
    spdlog::info("{}: {} steps, {:.1f} h", procedure->plan.procedure, procedure->plan.steps.size(),
                 procedure->plan.estimate.count() / 3600.0);
    planned.push_back(std::move(*procedure));
  }
  std::filesystem::path store = options.store;
  if (options.store.empty()) {
    const auto standard = record::default_store();
    if (!standard) return standard.error();
    store = *standard;
  }
  const std::uint64_t seed = options.seed.value_or(random_seed());
  if (planned.empty()) {
    return serve(std::move(*setup), seed, store, options.speed, options.serve);
  }

  AbortOnSignal abort_on_signal;
  SimulatedOperator obedient;
  TerminalOperator at_terminal(STDIN_FILENO, stderr, [&] { return abort_on_signal.asked(); });
  drivers::Operator& person =
      setup->simulated ? static_cast<drivers::Operator&>(obedient) : at_terminal;
  const std::string bench = setup->bench.name;
  const bool simulated = setup->simulated;
  auto session = Session::open(std::move(*setup), seed, store, options.speed, person);
  if (!session) return session.error();
  spdlog::info("bench {} is in its safe state; run log {}{}", bench, store.string(),
               simulated ? fmt::format(", seed {}", seed) : "");
  procedures::RunEngine& engine = (*session)->engine();
  abort_on_signal.attach(**session);
  std::size_t step = 0;
  engine.on_progress([&step](const procedures::Progress& now) {
    if (now.step + 1 == step) return;
    step = now.step + 1;
    spdlog::info("step {} of {}: {}", std::min(step, now.steps), now.steps, now.says);
  });
  engine.on_point([](const procedures::Point& point) {
    spdlog::info("{} at {:.1f} s: {:.4f} deg/h", point.segment, point.time_s, point.rate_deg_per_h);
  });
  for (const PlannedProcedure& procedure : planned) {
    if (abort_on_signal.asked()) return Error{ErrorCode::kAborted, "aborted on request"};
    step = 0;
    const auto summary = (*session)->run(procedure, user_name(getuid()));
    if (!summary) return summary.error();
    const procedures::RunEnd& end = summary->end;
    const std::string says =
        fmt::format("run {}, {}: {} points, {}; the bench is {}", summary->run,
                    procedure.plan.procedure, summary->points, end.reason,
                    end.safe_state_reached ? "in its safe state" : "NOT in its safe state");
    if (end.outcome == procedures::RunOutcome::kAborted) return Error{ErrorCode::kAborted, says};
    if (end.outcome == procedures::RunOutcome::kFailed) return Error{ErrorCode::kDevice, says};
    spdlog::info(says);
    if (summary->points > 0) {
      spdlog::info("next: fogbench verdict {0}{1}, fogbench passport {0}{1} -o passport-{0}.html",
                   summary->run, options.store.empty() ? "" : " --store " + options.store);
    }
  }
  return {};
}

}  // namespace
}  // namespace fogbench::daemon

int main(int argc, char** argv) {
  using fogbench::ExitStatus;
  spdlog::set_default_logger(spdlog::stderr_logger_mt("fogbenchd"));
  // UTC as in the record: an hour that daylight saving repeats would be there twice.
  spdlog::set_pattern("%Y-%m-%dT%H:%M:%S.%eZ %l %v", spdlog::pattern_time_type::utc);
  CLI::App app{"fogbenchd - runs acceptance procedures on a bench and logs them", "fogbenchd"};
  fogbench::daemon::DaemonOptions options;
  fogbench::daemon::declare(app, options);
  if (const auto manual =
          fogbench::daemon::asked_manual(argc, argv, app, fogbench::daemon::manual_text())) {
    return std::fputs(manual->c_str(), stdout) < 0 || std::fflush(stdout) != 0
               ? static_cast<int>(ExitStatus::kFailed)
               : static_cast<int>(ExitStatus::kDone);
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {  // --help, --version
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    fmt::print(stderr, "fogbenchd: {}\n",
               fogbench::daemon::mistyped(app, {argv + 1, argv + argc}, error));
    return static_cast<int>(ExitStatus::kUsage);
  }
  // Nothing of ours throws, and the engine leaves no run without the safe state; what a library may
  // still throw around it ends as one line.
  try {
    const auto status = fogbench::daemon::run(options);
    if (status) return static_cast<int>(ExitStatus::kDone);
    spdlog::error(status.error().message);
    return static_cast<int>(fogbench::config::exit_status(status.error().code));
  } catch (const std::exception& error) {
    spdlog::error(error.what());
    return static_cast<int>(ExitStatus::kFailed);
  }
}
