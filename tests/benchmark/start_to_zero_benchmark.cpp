// How long a coil supply stays energised after a restart: from fork and exec of fogbenchd to the
// arrival of "CURR 0" on its serial line, while nothing else on the bench can be reached. At most
// 1 s is allowed.

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>

#include "config/bench.hpp"
#include "tests/support/process.hpp"
#include "tests/support/pty.hpp"
#include "tests/support/source_tree.hpp"

namespace fogbench {
namespace {

using SteadyClock = std::chrono::steady_clock;
namespace fs = std::filesystem;

/// The ready bench, with one supply on `tty` and everything else nowhere.
std::string lonely_bench(const support::TemporaryFolder& folder, const std::string& tty) {
  const fs::path ready = tests::source_tree() / "config/benches/simulated.json";
  auto bench = nlohmann::ordered_json::parse(support::read_text(ready));
  for (const char* key : {"$schema", "simulation"}) bench.erase(key);
  for (auto& [name, instrument] : bench.items()) {
    if (!instrument.is_object() || !instrument.contains("connection")) continue;
    instrument["connection"] = "tty:" + (folder / name).string();
    const std::string device = instrument["device"];
    instrument["device"] = config::device_file(ready, device)->string();
  }
  bench["coil_horizontal"]["connection"] = "tty:" + tty;
  bench["thermostat"]["connection"] = "tcp:127.0.0.1:1";
  bench["magnetometer"]["connection"] = "hid:0x1209:0x0001:NOBODY";
  return folder.file("bench.json", bench.dump()).string();
}

/// Reads the line until the zero is there; false when none has come within 10 s.
bool zero_comes(const support::Pty& line) {
  std::string heard;
  pollfd ready{line.fd(), POLLIN, 0};
  const auto deadline = SteadyClock::now() + std::chrono::seconds{10};
  while (heard.find("CURR 0") == std::string::npos && SteadyClock::now() < deadline) {
    char bytes[256];
    if (poll(&ready, 1, 1) <= 0 || (ready.revents & POLLIN) == 0) continue;
    const ssize_t count = read(line.fd(), bytes, sizeof bytes);
    if (count > 0) heard.append(bytes, static_cast<std::size_t>(count));
  }
  return heard.find("CURR 0") != std::string::npos;
}

void start_to_zero(benchmark::State& state) {
  double worst_ms = 0.0;
  for (auto _ : state) {
    const support::TemporaryFolder folder;
    const support::Pty line;
    const std::vector<std::string> command{(tests::build_tree() / "fogbenchd").string(),
                                           "--bench",
                                           lonely_bench(folder, line.path()),
                                           "--store",
                                           (folder / "store.db").string(),
                                           "--socket",
                                           (folder / "s.sock").string()};
    const auto begun = SteadyClock::now();
    support::Process daemon(command);
    if (!zero_comes(line)) state.SkipWithError("no zero came");
    const std::chrono::duration<double> took = SteadyClock::now() - begun;
    state.SetIterationTime(took.count());
    worst_ms = std::max(worst_ms, 1e3 * took.count());
    daemon.signal(SIGKILL);
  }
  state.counters["worst_ms"] = worst_ms;
}
BENCHMARK(start_to_zero)
    ->Name("fogbenchd/start_to_CURR_0")
    ->UseManualTime()
    ->Iterations(20)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace fogbench
