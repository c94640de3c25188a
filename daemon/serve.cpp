#include "daemon/serve.hpp"

#include <fmt/format.h>
#include <pthread.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <thread>

#include "daemon/abort_on_signal.hpp"
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
#include "daemon/service_manager.hpp"
#include "daemon/stop_signals.hpp"
#include "record/run_log.hpp"

namespace fogbench::daemon {
namespace {

/// What a start and a stop are in the bench's record.
constexpr auto kStarted = R"({"daemon":"started"})", kStopped = R"({"daemon":"stopped"})";

/// How often a missing instrument is tried again, and how soon an end is noticed meanwhile.
constexpr std::chrono::milliseconds kBetweenTries{1000}, kBetweenLooks{100};

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
  const auto log = record::RunLogReader::open(store);
  if (!log) return log.error();
  const auto left = interrupted_runs(**log, setup);
  if (!left) return left.error();
  for (const record::StoredRun& run : *left) {
    const procedures::RunHeader& header = run.header;
    const auto resumed = plan_resumption(**log, run.run, setup);
    const std::string obstacle = resumed ? "" : resumed.error().message;
    spdlog::warn("run {}, {}, was interrupted; {} given up (fogbench resume {} --discard)", run.run,
                 header.procedure,
                 resumed ? fmt::format("it waits to be taken up (fogbench resume {}) or", run.run)
                         : obstacle + "; it waits to be",
                 run.run);
    desk.offer({run.run, header.procedure, header.operator_name, header.started_at,
                run.points - run.points_void, header.gyro_serial_number, obstacle});
  }
  if (const Status loaded = queue.load(desk, setup, store); !loaded) return loaded;
  const std::size_t jobs = desk.view().jobs;
  if (jobs > 0) spdlog::warn("{} runs wait in the queue, which is held (fogbench resume)", jobs);
  return {};
}

/// Tells the log how far each actuator came, once for each change of it.
void report(const drivers::SafetyReport& safety, std::string& said) {
  std::string text = safety.text();
  if (text == said) return;
  spdlog::log(safety.reached() ? spdlog::level::info : spdlog::level::critical, "safe state: {}",
              text);
  said = std::move(text);
}

/// What the run log says of the daemon before this one, for the bench's record.
Result<std::string> last_end(const std::filesystem::path& store, const std::string& bench) {
  const auto log = record::RunLogReader::open(store);
  if (!log) return log.error();
  const auto events = (*log)->bench_events();
  if (!events) return events.error();
  for (auto event = events->rbegin(); event != events->rend(); ++event) {
    if (event->bench != bench) continue;
    if (event->data_json == kStopped) return std::string();
    if (event->data_json != kStarted) continue;
    return fmt::format(
        "; the one that started at {} did not stop by itself: it was killed, it "
        "crashed, or the power was cut",
        drivers::utc_text(event->unix_s));
  }
  return std::string();
}

/// The latest date in the run log; 0 where there is none.
double last_trace_unix_s(const std::filesystem::path& store) {
  const auto log = record::RunLogReader::open(store);
  if (!log) return 0.0;  // whoever writes to it says what is wrong
  double last = 0.0;
  const auto events = (*log)->bench_events();
  if (events && !events->empty()) last = events->back().unix_s;
  const auto runs = (*log)->runs();
  if (!runs || runs->empty()) return last;
  const record::StoredRun& run = runs->back();
  const auto zero = (*log)->zero_unix_s(run);
  const auto trace = (*log)->last_time(run.run);
  return zero && trace ? std::max(last, *zero + *trace) : last;
}

/// Until every actuator is off and every instrument has begun, or the desk closes: what is missing
/// may be plugged in any minute.
bool begin_bench(Session& session, RunDesk& desk, DeskRecorder& record, std::string& said) {
  std::string missing;
  for (;;) {
    const Status begun = session.begin();
    const drivers::SafetyReport safety = session.make_safe();
    report(safety, said);
    if (begun && safety.reached()) {
      if (!missing.empty()) desk.happened("info", "every instrument is there, the bench is safe");
      desk.bench_waits_for({});
      return true;
    }
    const Error error = begun ? safety.status().error() : begun.error();
    if (error.message != missing) {
      missing = error.message;
      spdlog::error("{}; waiting for it", missing);
      desk.bench_waits_for(missing);
      desk.happened("warning", missing + "; the bench waits for it");
    }
    record.record_bench_events();
    for (auto waited = kBetweenLooks; waited <= kBetweenTries; waited += kBetweenLooks) {
      if (!desk.still_open()) return false;
      drivers::SteadyClock().sleep_for(kBetweenLooks);
    }
  }
}

/// The bench's thread.
void run_jobs(Session& session, RunDesk& desk, DeskOperator& person, DeskRecorder& record,
              std::string said) {
  const auto meanwhile = [&] {
    const std::string heard = session.listen();
    if (!heard.empty()) desk.happened("info", heard);
    record.record_bench_events();
  };
  try {
    record.record_bench_events();
    if (begin_bench(session, desk, record, said)) {
      session.record_in(record);
      procedures::RunEngine& engine = session.engine();
      engine.on_progress([&desk, &session](const procedures::Progress& now) {
        desk.progressed(now);
        desk.saw(session.stream());
      });
      desk.attach(engine);
      person.attach(engine);
      spdlog::info("the bench is ready");
    }
    while (const auto job = desk.next_job(meanwhile)) {
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
      // What could not be reached carries what it carried, whether or not another job comes.
      if (!session.engine().left_safe()) begin_bench(session, desk, record, said);
    }
  } catch (const std::exception& error) {
    end_at_once(fmt::format("an unexpected error: {}", error.what()), &session);
  }
}

/// Serves until the bench's thread has left the desk. `report` is called several times a second.
void serve_clients(ControlServer& server, const ControlMethods& methods, RunDesk& desk,
                   StopSignals& signals, Session& session, drivers::Clock& clock,
                   drivers::Clock::Duration abort_time, const std::function<void()>& report) {
  constexpr auto kNever = drivers::Clock::Instant::max();
  auto forced_at = kNever;  // when the abort under way will have lasted too long
  while (!desk.deserted()) {
    server.serve_once();
    report();
    while (const auto signal = signals.next()) {
      switch (signal->means) {
        case StopSignals::Means::kAbort:
          spdlog::info("{}: stopping", signal->name);
          desk.happened("info", signal->name + ": the daemon stops");
          desk.close({signal->name, static_cast<std::uint32_t>(geteuid())});
          report();
          break;
        case StopSignals::Means::kSameEvent:
          spdlog::info("{}: stopping already", signal->name);
          break;
        case StopSignals::Means::kForcedEnd:
          end_at_once("a second signal, " + signal->name, &session);
      }
    }
    if (methods.forced()) end_at_once("a forced abort", &session);
    if (!desk.aborting()) {
      forced_at = kNever;
    } else if (forced_at == kNever) {
      forced_at = clock.now() + abort_time;
    } else if (clock.now() > forced_at) {
      end_at_once(
          fmt::format("no safe state within {} s of the abort", drivers::to_seconds(abort_time)),
          &session);
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
  drivers::SteadyClock clock;
  StopSignals signals(clock);
  if (speed != Speed::kRealtime) setup.calendar_from_unix_s = std::ceil(last_trace_unix_s(store));
  const Setup planned_for = setup;
  RunDesk desk;
  DeskOperator person(desk);
  // First of all: whatever is wrong below, nothing stays energised.
  auto session = Session::attach(std::move(setup), seed, speed, person);
  if (!session) return session.error();
  std::string said;
  report((*session)->make_safe(), said);

  const auto rules = rules_of(options);
  if (!rules) return rules.error();
  raise_descriptor_limit();
  auto queue = QueueFile::open(store);
  if (!queue) return queue.error();
  const auto socket = open_socket(options.socket, rules->socket_mode());
  if (!socket) return socket.error();
  const auto metrics = MetricsFile::open(options.metrics, clock);
  if (!metrics) return metrics.error();
  const auto log = record::RunLog::open(store);
  if (!log) return log.error();
  const std::string bench = planned_for.bench.name;
  DeskRecorder record(**log, desk, [&log, &bench](const record::BenchEvent& event) {
    return (*log)->bench_event(bench, event);
  });
  // The bench's clock follows the machine's calendar on the other thread, or never.
  desk.dated_by([&bench_clock = (*session)->clock(), real = speed == Speed::kRealtime] {
    const auto now = real ? drivers::SteadyClock::system_calendar() : bench_clock.wall_now();
    return std::chrono::duration<double>(now.time_since_epoch()).count();
  });
  const auto before = last_end(store, bench);
  if (!before) return before.error();
  desk.happened(
      before->empty() ? "info" : "warning",
      fmt::format("fogbenchd {} started, bench {}: {}{}", FOGBENCH_VERSION, bench, said, *before),
      {}, kStarted);
  if (const Status taken = take_over(planned_for, store, *queue, desk); !taken) return taken;
  spdlog::info("bench {}; run log {}{}; serving {}", planned_for.bench.name, store.string(),
               planned_for.simulated ? fmt::format(", seed {}", seed) : "", (*socket)->name());

  ControlMethods methods(desk, planned_for, store);
  methods.totals().started_unix_s = drivers::to_seconds(clock.wall_now().time_since_epoch());
  ControlServer server((*socket)->descriptor(), signals.descriptor(), *rules, methods, clock);
  std::thread bench_thread(run_jobs, std::ref(**session), std::ref(desk), std::ref(person),
                           std::ref(record), said);
  pthread_setname_np(bench_thread.native_handle(), "bench");
  ServiceManager manager(clock);
  manager.ready();
  serve_clients(server, methods, desk, signals, **session, clock, options.abort_time, [&] {
    manager.report(desk);
    methods.totals().connections = server.connections();
    methods.totals().connections_refused = server.refused();
    desk.look();
    queue->update(desk);
    (*metrics)->update([&] { return methods.metrics(); });
  });
  bench_thread.join();

  // Once more: an instrument may have come back since.
  const Status safe = (*session)->make_safe().status();
  desk.happened(safe ? "info" : "error",
                "fogbenchd stopped; the bench is " +
                    (safe ? std::string("in its safe state")
                          : "NOT in its safe state: " + safe.error().message),
                {}, kStopped);
  record.record_bench_events();
  if (!safe) return safe;
  spdlog::info("stopped; the bench is in its safe state");
  return {};
}

}  // namespace fogbench::daemon
