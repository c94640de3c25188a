// The dry run through the complete path: simulated plant and gyro noise, serial bytes, CRC, frame
// parser, averaging, compressed run log on disk. Aim: one coil-sweep and one thermostat-steps at
// 1 kHz (some 25 million frames) within 6 s on one core, in less than 200 MB. And what the run log
// alone costs a frame: 15 to 20 ns.

#include <benchmark/benchmark.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "daemon/session.hpp"
#include "daemon/simulated_operator.hpp"
#include "record/run_log_reader.hpp"

namespace fogbench::daemon {
namespace {
namespace fs = std::filesystem;

/// A run log in a file of its own, removed at the end.
class TemporaryStore {
 public:
  TemporaryStore()
      : path_(fs::temp_directory_path() /
              ("fogbench-benchmark-" + std::to_string(getpid()) + ".db")) {}
  TemporaryStore(const TemporaryStore&) = delete;
  TemporaryStore& operator=(const TemporaryStore&) = delete;
  ~TemporaryStore() {
    for (const char* suffix : {"", "-wal", "-shm"}) fs::remove(path_.string() + suffix);
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

double peak_memory_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

/// Runs the procedures one after the other; adds the frames and the bench's seconds.
Status dry_run(const std::string& bench, const std::vector<std::string>& procedures,
               const fs::path& store, double& frames, double& bench_seconds) {
  auto setup = load_setup({.bench = bench});
  if (!setup) return setup.error();
  std::vector<PlannedProcedure> planned;
  for (const std::string& name : procedures) {
    auto procedure = plan_procedure(name, setup->bench, {});
    if (!procedure) return procedure.error();
    planned.push_back(std::move(*procedure));
  }
  const double frame_rate_hz = setup->bench.gyro.device.frame_rate_hz;
  SimulatedOperator person;
  auto session = Session::open(std::move(*setup), 1, store, Speed::kMaximum, person);
  if (!session) return session.error();
  procedures::RunSummary last;
  for (const PlannedProcedure& procedure : planned) {
    const auto summary = (*session)->run(procedure);
    if (!summary) return summary.error();
    last = *summary;
  }
  // The stream counts from its start, over all runs of the session.
  frames += static_cast<double>(last.end.stream.frames_good);
  bench_seconds += static_cast<double>(last.end.stream.frames_good) / frame_rate_hz;
  return {};
}

void run_procedures(benchmark::State& state, const std::string& bench,
                    const std::vector<std::string>& procedures) {
  double frames = 0.0, bench_seconds = 0.0;
  for (auto _ : state) {
    const TemporaryStore store;
    const Status done = dry_run(bench, procedures, store.path(), frames, bench_seconds);
    if (!done) {
      state.SkipWithError(done.error().message.c_str());
      return;
    }
  }
  state.counters["frames_per_s"] = benchmark::Counter(frames, benchmark::Counter::kIsRate);
  state.counters["times_real_time"] =
      benchmark::Counter(bench_seconds, benchmark::Counter::kIsRate);
  state.counters["peak_memory_mb"] = peak_memory_mb();
}

/// Frames as the navigation-grade gyro's: nothing in the mantissas compresses.
void log_frames(benchmark::State& state) {
  drivers::GyroBlock block;
  std::mt19937 random(1);
  std::normal_distribution<float> rate(12.4F, 1.9F);
  for (std::int64_t i = 0; i < 100; ++i) {
    block.index.push_back(i);
    block.rate_deg_per_h.push_back(rate(random));
    block.temperature_c.push_back(21.0F);
  }
  const TemporaryStore store;
  auto log = record::RunLog::open(store.path());
  if (!log || !(*log)->begin_run({}, {})) {
    state.SkipWithError("no run log");
    return;
  }
  double frames = 0.0;
  for (auto _ : state) {
    if (!(*log)->gyro_samples(block)) {
      state.SkipWithError("not written");
      return;
    }
    for (std::int64_t& index : block.index) index += 100;
    frames += 100.0;
  }
  state.counters["frames_per_s"] = benchmark::Counter(frames, benchmark::Counter::kIsRate);
}

BENCHMARK(log_frames)->MinTime(1.0);
BENCHMARK_CAPTURE(run_procedures, both_100_hz, "simulated",
                  std::vector<std::string>{"coil-sweep", "thermostat-steps"})
    ->Unit(benchmark::kSecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(run_procedures, both_1_khz, "simulated-1khz",
                  std::vector<std::string>{"coil-sweep", "thermostat-steps"})
    ->Unit(benchmark::kSecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(run_procedures, acceptance_100_hz, "simulated",
                  std::vector<std::string>{"acceptance"})
    ->Unit(benchmark::kSecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(run_procedures, acceptance_1_khz, "simulated-1khz",
                  std::vector<std::string>{"acceptance"})
    ->Unit(benchmark::kSecond)
    ->UseRealTime();

}  // namespace
}  // namespace fogbench::daemon
