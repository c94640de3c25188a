// Comparing a model with its measurements under coloured noise, for a thermal test (157 averages of
// 1 min), a whole acceptance (700), and a long record (20,000, too many for draws under every noise
// shape). A search among candidate models compares many times.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>

#include "model/compare/compare.hpp"

namespace fogbench::model {
namespace {

/// Six set points approached exponentially; any residual will do: the work does not depend on it.
Table heated(int rows) {
  std::vector<double> time, duration, temperature, rate_of_change, heater, error, rate;
  std::uint64_t state = 1;  // a plain congruential generator
  for (int i = 0; i < rows; ++i) {
    state = state * 6364136223846793005U + 1442695040888963407U;
    const double noise = static_cast<double>(state >> 40) / (1 << 24) - 0.5;
    const int step = 6 * i / rows;
    const double since = (6.0 * i / rows - step) * 5.0;
    const double t = 10.0 + 5.0 * (step - std::exp(-since));
    time.push_back(60.0 * i + 30.0);
    duration.push_back(60.0);
    temperature.push_back(21.0 + t);
    rate_of_change.push_back(50.0 * std::exp(-since));
    heater.push_back(0.2 * t + 6.0 * std::exp(-since));
    error.push_back(0.027);
    rate.push_back(1.3 - 0.12 * t + 0.004 * t * t + 0.02 * rate_of_change.back() + 0.1 * noise);
  }
  Table table;
  table.set_column("time_s", std::move(time));
  table.set_column("duration_s", std::move(duration));
  table.set_column("temperature_c", std::move(temperature));
  table.set_column("temperature_rate_c_per_h", std::move(rate_of_change));
  table.set_column("heater_w", std::move(heater));
  table.set_column("rate_std_error_deg_per_h", std::move(error));
  table.set_column("rate_deg_per_h", std::move(rate));
  return table;
}

void BM_Compare(benchmark::State& state) {
  const Table table = heated(static_cast<int>(state.range(0)));
  config::ModelFile model;
  for (const char* effect :
       {"bias", "temperature_linear", "temperature_quadratic", "temperature_rate"}) {
    model.terms.emplace_back().effect = effect;
  }
  for (auto _ : state) {
    const auto result = compare(table, model, {});
    if (!result) state.SkipWithError(result.error().message.c_str());
    benchmark::DoNotOptimize(result);
  }
}
BENCHMARK(BM_Compare)->Arg(157)->Arg(700)->Arg(20'000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace fogbench::model
