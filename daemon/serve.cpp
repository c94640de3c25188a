#include "daemon/serve.hpp"

#include <fmt/format.h>
#include <pthread.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <thread>

#include "config/exit_status.hpp"
#include "daemon/access.hpp"
#include "daemon/control_methods.hpp"
#include "daemon/control_server.hpp"
#include "daemon/control_socket.hpp"
#include "daemon/desk_operator.hpp"
#include "daemon/desk_recorder.hpp"
#include "daemon/metrics.hpp"
#include "daemon/queue_file.hpp"
#include "daemon/resumption.hpp"
#include "daemon/run_desk.hpp"
#include "daemon/run_log.hpp"
#include "daemon/service_manager.hpp"
#include "drivers/file_descriptor.hpp"

namespace fogbench::daemon {
namespace {

[[noreturn]] void end_at_once(const std::string& why) {
  spdlog::critical(
      "{}: ending at once, the bench is NOT in its safe state; a new start begins "
      "with it",
      why);
  spdlog::default_logger()->flush();
  _exit(static_cast<int>(ExitStatus::kFailed));
}

/// From here on the signals that end the process are read from the descriptor, in all threads that
/// are started later, too.
int take_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int number : {SIGTERM, SIGINT}) sigaddset(&signals, number);
  struct sigaction hangup {};
  sigaction(SIGHUP, nullptr, &hangup);
  if (hangup.sa_handler != SIG_IGN) sigaddset(&signals, SIGHUP);  // nohup asked to survive it
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is a full disk
  return signalfd(-1, &signals, SFD_CLOEXEC | SFD_NONBLOCK);
}

/// Empty when none has come.
std::string next_signal(int descriptor) {
  signalfd_siginfo info{};
  if (read(descriptor, &info, sizeof info) != sizeof info) return {};
  return fmt::format("SIG{}", sigabbrev_np(static_cast<int>(info.ssi_signo)));
}

/// For as many connections as the server allows.
void raise_descriptor_limit() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  constexpr rlim_t kEnough = 2 * ControlServer::kMostConnections;
  limit.rlim_cur = std::min(std::max(limit.rlim_cur, kEnough), limit.rlim_max);
  setrlimit(RLIMIT_NOFILE, &limit);
}

Result<AccessRules> rules_of(const ServeOptions& options) {
  AccessRules rules{geteuid(), {}, {}};
  for (const auto& [name, group] : {std::pair{&options.operators, &rules.operators},
                                    std::pair{&options.observers, &rules.observers}}) {
    if (name->empty()) continue;
    const auto found = group_by_name(*name);
    if (!found) return found.error();
    *group = *found;
  }
  return rules;
}

Result<std::unique_ptr<ControlSocket>> open_socket(const std::string& named, mode_t mode) {
  auto inherited = ControlSocket::inherited();
  if (!inherited || *inherited) return inherited;
  if (!named.empty()) return ControlSocket::open(named, mode);
  const auto standard = socket_to_serve();
  if (!standard) return standard.error();
  return ControlSocket::open(*standard, mode);
}

/// What the last daemon left behind: a run that it did not end, and what was to be run after it.
Status take_over(const Setup& setup, const std::filesystem::path& store, QueueFile& queue,
                 RunDesk& desk) {
  const auto log = RunLogReader::open(store);
  if (!log) return log.error();
  const auto left = interrupted_run(**log, setup);
  if (!left) return left.error();
  if (*left) {
    const procedures::RunHeader& header = (*left)->header;
    spdlog::warn(
        "run {}, {}, was interrupted; it waits to be taken up (fogbench resume {}) or "
        "given up (fogbench resume {} --discard)",
        (*left)->run, header.procedure, (*left)->run, (*left)->run);
    desk.offer({(*left)->run, header.procedure, header.operator_name, header.started_at,
                (*left)->points - (*left)->points_void, header.gyro_serial_number});
  }
  if (const Status loaded = queue.load(desk, setup, store); !loaded) return loaded;
  const std::size_t jobs = desk.view().jobs;
  if (jobs > 0) spdlog::warn("{} runs wait in the queue, which is held (fogbench resume)", jobs);
  return {};
}

/// The bench's thread.
void run_jobs(Session& session, RunDesk& desk) {
  try {
    while (const auto job = desk.next_job()) {
      const std::string& name = job->procedure.plan.procedure;
      spdlog::info("job {}, {}, gyro \"{}\": begins, asked for by {}", job->job, name,
                   job->procedure.gyro, job->by.name);
      const auto summary = session.run(job->procedure, job->by.name);
      if (summary) {
        const procedures::RunEnd& end = summary->end;
        spdlog::log(end.safe_state_reached ? spdlog::level::info : spdlog::level::critical,
                    "run {}, {}: {} points, {}; the bench is {}", summary->run, name,
                    summary->points, end.reason,
                    end.safe_state_reached ? "in its safe state" : "NOT in its safe state");
      } else {
        spdlog::error("job {}, {}: {}", job->job, name, summary.error().message);
      }
      desk.run_ended(summary);
    }
  } catch (const std::exception& error) {
    end_at_once(fmt::format("an unexpected error: {}", error.what()));
  }
}

/// Serves until the bench's thread has left the desk. `report` is called several times a second.
void serve_clients(ControlServer& server, const ControlMethods& methods, RunDesk& desk, int signals,
                   drivers::Clock& clock, drivers::Clock::Duration abort_time,
                   const std::function<void()>& report) {
  bool asked_to_end = false;
  constexpr auto kNever = drivers::Clock::Instant::max();
  auto forced_at = kNever;  // when the abort under way will have lasted too long
  while (!desk.deserted()) {
    server.serve_once();
    report();
    for (auto signal = next_signal(signals); !signal.empty(); signal = next_signal(signals)) {
      if (asked_to_end) end_at_once("a second signal, " + signal);
      asked_to_end = true;
      spdlog::info("{}: stopping", signal);
      desk.close({signal, static_cast<std::uint32_t>(geteuid())});
      report();
    }
    if (methods.forced()) end_at_once("a forced abort");
    if (!desk.aborting()) {
      forced_at = kNever;
    } else if (forced_at == kNever) {
      forced_at = clock.now() + abort_time;
    } else if (clock.now() > forced_at) {
      end_at_once(
          fmt::format("no safe state within {} s of the abort", drivers::to_seconds(abort_time)));
    }
  }
}

}  // namespace

Status serve(Setup setup, std::uint64_t seed, const std::filesystem::path& store, Speed speed,
             const ServeOptions& options) {
  if (speed == Speed::kMaximum) {
    return Error{ErrorCode::kUsage,
                 "--speed max waits for nobody; serving needs realtime, or a number that is as "
                 "many times faster)"};
  }
  const auto rules = rules_of(options);
  if (!rules) return rules.error();
  raise_descriptor_limit();
  // Before the bench: two daemons must not touch one.
  const auto socket = open_socket(options.socket, rules->socket_mode());
  if (!socket) return socket.error();
  drivers::SteadyClock clock;
  const auto metrics = MetricsFile::open(options.metrics, clock);
  if (!metrics) return metrics.error();
  const drivers::FileDescriptor signals(take_signals());

  const Setup planned_for = setup;
  const std::string seeded = setup.simulated ? fmt::format(", seed {}", seed) : "";
  RunDesk desk;
  std::unique_ptr<RunLog> log;
  std::optional<DeskRecorder> record;
  DeskOperator person(desk);
  const Session::OpenRecord open_record = [&]() -> Result<procedures::Recorder*> {
    auto opened = RunLog::open(store);
    if (!opened) return opened.error();
    log = std::move(*opened);
    return &record.emplace(*log, desk);
  };
  auto session = Session::open(std::move(setup), seed, open_record, speed, person);
  if (!session) return session.error();
  QueueFile queue(store);
  if (const Status taken = take_over(planned_for, store, queue, desk); !taken) return taken;
  procedures::RunEngine& engine = (*session)->engine();
  engine.on_progress([&desk, &open = **session](const procedures::Progress& now) {
    desk.progressed(now);
    desk.saw(open.stream());
  });
  desk.attach(engine);
  person.attach(engine);
  spdlog::info("bench {} is in its safe state; run log {}{}; serving {}", planned_for.bench.name,
               store.string(), seeded, (*socket)->name());

  ControlMethods methods(desk, planned_for, store);
  methods.totals().started_unix_s = drivers::to_seconds(clock.wall_now().time_since_epoch());
  ControlServer server((*socket)->descriptor(), signals.get(), *rules, methods, clock);
  std::thread bench_thread(run_jobs, std::ref(**session), std::ref(desk));
  pthread_setname_np(bench_thread.native_handle(), "bench");
  ServiceManager manager(clock);
  manager.ready();
  serve_clients(server, methods, desk, signals.get(), clock, options.abort_time, [&] {
    manager.report(desk);
    methods.totals().connections = server.connections();
    methods.totals().connections_refused = server.refused();
    queue.update(desk);
    (*metrics)->update([&] { return methods.metrics(); });
  });
  bench_thread.join();

  const auto last = desk.view().last_run;
  if (last && !last->safe_state_reached) return Error{ErrorCode::kDevice, last->reason};
  spdlog::info("stopped; the bench is in its safe state");
  return {};
}

}  // namespace fogbench::daemon
