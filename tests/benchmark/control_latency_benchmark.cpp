// How long an abort takes to reach the wire: from RunEngine::request_abort to the supply's "CURR
// 0", through the real engine and the real SCPI driver, on the machine's clock. The instruments
// answer at once, so what is measured is ours alone; at most 20 ms are allowed.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <random>
#include <thread>

#include "drivers/scpi_coil_supply.hpp"
#include "procedures/run_engine.hpp"
#include "tests/support/fake_bench.hpp"
#include "tests/support/fake_transports.hpp"
#include "tests/support/memory_recorder.hpp"

namespace fogbench::procedures {
namespace {

using WallClock = std::chrono::steady_clock;

/// A stream of 1 kHz on the machine's clock.
class SteadyGyro final : public drivers::Gyro {
 public:
  explicit SteadyGyro(const drivers::Clock& clock) : clock_(clock) {}
  Result<std::string> identity() override { return std::string("steady"); }
  Status read(drivers::GyroBlock& out) override {
    const auto due = clock_.now().time_since_epoch() / std::chrono::milliseconds{1};
    for (; next_ < due; ++next_) {
      out.index.push_back(next_);
      out.rate_deg_per_h.push_back(12.5F);
    }
    return {};
  }
  const drivers::StreamStatistics& statistics() const override { return statistics_; }
  drivers::Clock::Instant time_of(std::int64_t index) const override {
    return drivers::Clock::Instant{std::chrono::microseconds{index * 1000 + 500}};
  }
  double frame_rate_hz() const override { return 1000.0; }
  std::optional<drivers::FrameRate> measured_frame_rate() const override {
    return drivers::FrameRate{1000.0};
  }

 private:
  const drivers::Clock& clock_;
  std::int64_t next_ = 0;
  drivers::StreamStatistics statistics_;
};

/// A supply that obeys at once and notes when it was last told to go to zero.
struct Supply {
  Supply() {
    far.answers = {{"*IDN?", "K"}, {"CURR?", "0"}, {"MEAS:CURR?", "0"}};
    far.before_write = [this](const std::string& text) {
      if (text.starts_with("CURR 0.0")) zero_at = WallClock::now();
    };
  }
  std::unique_ptr<drivers::CoilSupply> driver(drivers::Clock& clock) {
    config::CoilConfig config;
    config.device = {.identity = "K",
                     .set = "CURR {value}",
                     .set_query = "CURR?",
                     .measure_query = "MEAS:CURR?",
                     .minimum = -4.0,
                     .maximum = 4.0,
                     .read_back_tolerance = 0.01,
                     .settle = config::Seconds{0.0}};
    auto supply = drivers::begun(drivers::ScpiCoilSupply::attach(
        "coil", config, std::make_unique<support::FakeMessages>(far), clock));
    return supply ? std::move(*supply) : nullptr;
  }
  support::FakeScpi far;
  WallClock::time_point zero_at{};
};

void abort_to_wire(benchmark::State& state) {
  Plan plan;
  PlannedStep step;
  step.action = Wait{Seconds{60.0}};
  step.says = "wait";
  plan.steps.push_back(step);
  const config::BenchConfig config;
  std::mt19937 random(1);
  double worst_ms = 0.0;
  for (auto _ : state) {
    drivers::SteadyClock clock;
    test::FakePlant plant;
    Supply supply;
    drivers::Bench bench = test::fake_bench(plant);
    bench.gyro = std::make_unique<SteadyGyro>(clock);
    bench.coil_horizontal = supply.driver(clock);
    test::FakeOperator person{plant};
    test::MemoryRecorder log;
    RunEngine engine{config, bench, clock, person, log};
    std::thread runs([&] { (void)engine.run(plan, RunHeader{}); });
    // At any phase of the engine's second.
    std::this_thread::sleep_for(std::chrono::milliseconds{200 + random() % 1000});
    const auto asked = WallClock::now();
    engine.request_abort();
    runs.join();
    const std::chrono::duration<double> took = supply.zero_at - asked;
    state.SetIterationTime(took.count());
    worst_ms = std::max(worst_ms, 1e3 * took.count());
    if (took.count() <= 0.0) state.SkipWithError("no zero was sent after the abort");
  }
  state.counters["worst_ms"] = worst_ms;
}
BENCHMARK(abort_to_wire)
    ->Name("RunEngine/abort_to_CURR_0")
    ->UseManualTime()
    ->Iterations(50)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace fogbench::procedures
