// How long a client of the control socket waits for the status, alone and as one of a thousand that
// ask every half second, while the bench's thread reports a thousand times a second: median and
// 99.9 % of the requests, and the longest that a report of the bench had to wait for the desk.

#include <benchmark/benchmark.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <thread>

#include "daemon/control_methods.hpp"
#include "daemon/control_socket.hpp"
#include "tests/support/polling_clients.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fogbench::daemon {
namespace {

using namespace std::chrono_literals;
using SteadyClock = std::chrono::steady_clock;

void wait_for_the_status(benchmark::State& state) {
  const support::TemporaryFolder folder;
  const auto socket = ControlSocket::open(folder / "s", 0600);
  if (!socket) return state.SkipWithError(socket.error().message.c_str());
  RunDesk desk;
  ControlMethods methods(desk, Setup{}, folder / "store.db");
  drivers::SteadyClock clock;
  const drivers::FileDescriptor wake(eventfd(0, EFD_CLOEXEC));
  ControlServer server((*socket)->descriptor(), wake.get(), AccessRules{geteuid(), {}, {}}, methods,
                       clock);
  std::atomic<bool> stop{false};
  desk.enqueue({}, PlannedProcedure{}, {"somebody", 1});
  (void)desk.next_job();
  std::thread serving([&] {
    while (!stop) server.serve_once();
  });
  double longest_us = 0.0;
  std::thread bench([&] {
    for (auto due = SteadyClock::now(); !stop; due += 1ms) {
      std::this_thread::sleep_until(due);
      const auto begun = SteadyClock::now();
      desk.progressed({});
      const std::chrono::duration<double, std::micro> took = SteadyClock::now() - begun;
      longest_us = std::max(longest_us, took.count());
    }
  });
  test::PollingClients clients((*socket)->name(), static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) clients.poll_for(5s, 500ms);
  stop = true;
  serving.join();
  bench.join();
  state.counters["requests"] = static_cast<double>(clients.answers());
  state.counters["median_ms"] = clients.latency_ms(0.5);
  state.counters["99.9%_ms"] = clients.latency_ms(0.999);
  state.counters["bench_waits_at_most_us"] = longest_us;
}
BENCHMARK(wait_for_the_status)
    ->Arg(1)
    ->Arg(1000)
    ->Iterations(1)
    ->UseRealTime()
    ->Unit(benchmark::kSecond);

}  // namespace
}  // namespace fogbench::daemon
