// How long a gyro sample takes to simulate: its noise alone, and the whole frame with truth,
// encoding and check value. A dry run of eight hours at 1 kHz makes 29 million of them.

#include <benchmark/benchmark.h>

#include <memory>
#include <vector>

#include "drivers/clock.hpp"
#include "simulator/gyro_far_end.hpp"
#include "simulator/noise_generator.hpp"
#include "tests/simulator/test_bench.hpp"

namespace fogbench::simulator {
namespace {

constexpr config::NoiseCoefficients kTactical{.angle_random_walk_deg_per_sqrt_h = 0.005,
                                              .bias_instability_deg_per_h = 0.02,
                                              .rate_random_walk_deg_per_h_per_sqrt_h = 0.02};

void per_item(benchmark::State& state, const char* name, std::int64_t items) {
  state.counters[name] = benchmark::Counter(
      static_cast<double>(items), benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.SetItemsProcessed(items);
}

void NoiseSample(benchmark::State& state) {
  NoiseGenerator generator(kTactical, 1.0 / static_cast<double>(state.range(0)), 1);
  for (auto _ : state) benchmark::DoNotOptimize(generator.next());
  per_item(state, "s_per_sample", static_cast<std::int64_t>(state.iterations()));
}
BENCHMARK(NoiseSample)->ArgName("hz")->Arg(100)->Arg(1000);

/// A second of frames a turn, read as a driver reads them.
void GyroFrame(benchmark::State& state) {
  const auto frame_rate_hz = static_cast<double>(state.range(0));
  config::ScenarioConfig scenario;
  scenario.noise = kTactical;
  scenario.terms = {{"bias", 0.7}, {"temperature_linear", 0.1}, {"magnetic_linear_z", -0.25}};
  scenario.hidden = {{"magnetic_hysteresis_z", 0.1, {{"width", 0.6}}}};
  TestFarEnds bench(test_bench(frame_rate_hz), scenario);
  std::vector<std::byte> buffer(1U << 20U);
  std::int64_t bytes = 0;
  for (auto _ : state) {
    bench.run_for(1.0);
    bytes += static_cast<std::int64_t>(*bench.ends.gyro->read_some(buffer));
  }
  per_item(state, "s_per_frame", bytes / 36);
}
BENCHMARK(GyroFrame)->ArgName("hz")->Arg(100)->Arg(1000);

}  // namespace
}  // namespace fogbench::simulator
