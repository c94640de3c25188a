// What the run engine costs per gyro frame: a run on fakes, whose stream is as cheap as a stream
// can be, at 1 kHz. The target is 15 ns a frame; a dry run has 30 million of them.

#include <benchmark/benchmark.h>

#include <memory>
#include <numeric>

#include "procedures/frame_window.hpp"
#include "procedures/run_engine.hpp"
#include "tests/support/fake_bench.hpp"
#include "tests/support/memory_recorder.hpp"

namespace fogbench::procedures {
namespace {

constexpr double kFrameRateHz = 1000.0;

/// Appends what is due, with a rate that costs nothing to make.
class CheapGyro final : public drivers::Gyro {
 public:
  explicit CheapGyro(const drivers::Clock& clock) : clock_(clock) {}
  Result<std::string> identity() override { return std::string("cheap"); }
  Status read(drivers::GyroBlock& out) override {
    const auto due = clock_.now().time_since_epoch() / std::chrono::milliseconds{1};
    if (due <= next_) return {};
    const auto count = static_cast<std::size_t>(due - next_);
    out.index.resize(count);
    std::iota(out.index.begin(), out.index.end(), next_);
    out.rate_deg_per_h.resize(count, 12.5F);
    next_ = due;
    statistics_.frames_good += count;
    return {};
  }
  const drivers::StreamStatistics& statistics() const override { return statistics_; }
  drivers::Clock::Instant time_of(std::int64_t index) const override {
    return drivers::Clock::Instant{std::chrono::microseconds{index * 1000 + 500}};
  }
  double frame_rate_hz() const override { return kFrameRateHz; }
  std::optional<drivers::FrameRate> measured_frame_rate() const override {
    return drivers::FrameRate{kFrameRateHz};
  }

 private:
  const drivers::Clock& clock_;
  std::int64_t next_ = 0;
  drivers::StreamStatistics statistics_;
};

/// An hour of 180 s averages, everything watched and recorded in memory.
void run_an_hour(benchmark::State& state) {
  Plan plan;
  for (int i = 0; i < 20; ++i) {
    PlannedStep step;
    step.action = Average{Seconds{180.0}, "a"};
    step.says = "average";
    plan.steps.push_back(step);
  }
  const config::BenchConfig config;
  std::size_t frames = 0;
  for (auto _ : state) {
    test::FakePlant plant;
    drivers::Bench bench = test::fake_bench(plant);
    bench.gyro = std::make_unique<CheapGyro>(plant.clock);
    test::FakeOperator person{plant};
    test::MemoryRecorder log;
    RunEngine engine{config, bench, plant.clock, person, log};
    const auto summary = engine.run(plan, RunHeader{});
    if (!summary || summary->points != plan.steps.size()) state.SkipWithError("the run failed");
    frames += log.frames;
  }
  state.counters["frames_per_s"] =
      benchmark::Counter(static_cast<double>(frames), benchmark::Counter::kIsRate);
  state.counters["times_real_time"] =
      benchmark::Counter(static_cast<double>(frames) / kFrameRateHz, benchmark::Counter::kIsRate);
}
BENCHMARK(run_an_hour)->Name("RunEngine/an_hour_at_1_kHz")->Unit(benchmark::kMillisecond);

void average_blocks(benchmark::State& state) {
  drivers::GyroBlock block;
  block.index.resize(1000);
  block.rate_deg_per_h.resize(1000, 12.5F);
  FrameWindow window(0, std::int64_t{1} << 60, 100);
  std::int64_t next = 0;
  for (auto _ : state) {
    std::iota(block.index.begin(), block.index.end(), next);
    next += 1000;
    window.add(block);
    benchmark::DoNotOptimize(window);
  }
  state.SetItemsProcessed(state.iterations() * 1000);
}
BENCHMARK(average_blocks)->Name("FrameWindow/blocks_of_1000");

}  // namespace
}  // namespace fogbench::procedures
