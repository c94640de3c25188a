// How long a verdict takes: against the rows of the table (a sweep of one axis, the magnetic test,
// a mixed and a long programme), against the candidates (the columns that the bench records decide
// which effects can be tried), and on raw samples.

#include <benchmark/benchmark.h>

#include <cmath>
#include <random>

#include "tests/support/diagnosis_trial.hpp"

namespace {

using namespace fogbench;
using namespace fogbench::tests;

void diagnose_case(benchmark::State& state, const DiagnosisCase& what) {
  TrialMaker maker;
  const Trial trial = maker.make(what, 0);
  for (auto _ : state) benchmark::DoNotOptimize(answer_of(trial).says.data());
  state.counters["rows"] = static_cast<double>(trial.table.rows());
}

void BM_NothingMissing(benchmark::State& state) {
  const auto design = static_cast<Design>(state.range(0));
  state.SetLabel(name_of(design));
  diagnose_case(state, {.part = "benchmark", .design = design});
}
BENCHMARK(BM_NothingMissing)
    ->Arg(static_cast<int>(Design::kOneAxis))
    ->Arg(static_cast<int>(Design::kMagnetic))
    ->Arg(static_cast<int>(Design::kTwoRuns))
    ->Arg(static_cast<int>(Design::kMixed))
    ->Arg(static_cast<int>(Design::kThermalCooling))
    ->Arg(static_cast<int>(Design::kLong))
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

void BM_OneEffectMissing(benchmark::State& state) {
  const auto design = static_cast<Design>(state.range(0));
  state.SetLabel(name_of(design));
  diagnose_case(state, {.part = "benchmark",
                        .design = design,
                        .hidden = {design == Design::kThermalCooling ? "temperature_hysteresis"
                                                                     : "magnetic_hysteresis_z"},
                        .s = 16.0});
}
BENCHMARK(BM_OneEffectMissing)
    ->Arg(static_cast<int>(Design::kMagnetic))
    ->Arg(static_cast<int>(Design::kMixed))
    ->Arg(static_cast<int>(Design::kThermalCooling))
    ->Arg(static_cast<int>(Design::kLong))
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

/// The thermal test with few candidates (no rate, gradient, heater or room temperature recorded)
/// and with all of them.
void BM_Candidates(benchmark::State& state) {
  const bool all = state.range(0) != 0;
  const ForeignColumns columns{
      .temperature_rate = all, .gradient = all, .heater = all, .ambient = all};
  state.SetLabel(all ? "every column" : "fewest columns");
  diagnose_case(state,
                {.part = "benchmark", .design = Design::kThermalCooling, .columns = columns});
}
BENCHMARK(BM_Candidates)
    ->Arg(0)
    ->Arg(1)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

/// Raw samples of a thermal hour as an acquisition system writes them: time, rate, temperature, a
/// field. White and random-walk noise; a quadratic temperature error is missing.
model::Table raw_samples(std::size_t rows) {
  constexpr double kHours = 3.0;
  std::mt19937_64 engine(1);
  std::normal_distribution<> normal;
  const double step_h = kHours / static_cast<double>(rows);
  std::vector<double> time(rows), duration(rows, step_h * 3600.0), rate(rows), temperature(rows),
      field(rows);
  double walk = 0.0;
  for (std::size_t i = 0; i < rows; ++i) {
    const double hours = (static_cast<double>(i) + 0.5) * step_h;
    const double t = 30.0 * std::sin(hours);
    walk += 0.003 * std::sqrt(step_h) * normal(engine);
    time[i] = hours * 3600.0;
    temperature[i] = 21.0 + t;
    field[i] = 300.0 * std::sin(7.0 * hours);
    rate[i] = 0.7 - 0.01 * t - 0.0025 * field[i] + 2e-4 * t * t + walk +
              0.001 / std::sqrt(step_h) * normal(engine);
  }
  model::Table table;
  table.set_column("time_s", std::move(time));
  table.set_column("duration_s", std::move(duration));
  table.set_column("rate_deg_per_h", std::move(rate));
  table.set_column("temperature_c", std::move(temperature));
  table.set_column("field_z_ut", std::move(field));
  return table;
}

void BM_RawSamples(benchmark::State& state) {
  const model::Table table = raw_samples(static_cast<std::size_t>(state.range(0)));
  config::ModelFile model{.name = "raw"};
  for (const char* id : {"bias", "temperature_linear", "magnetic_linear_z"}) {
    model.terms.push_back({});
    model.terms.back().effect = id;
  }
  for (auto _ : state) {
    const auto diagnosis = model::diagnose(table, model, {});
    if (!diagnosis) {
      state.SkipWithError(diagnosis.error().message.c_str());
      break;
    }
    state.SetLabel(std::string(model::name_of(diagnosis->verdict)));
  }
}
BENCHMARK(BM_RawSamples)
    ->Arg(2'000)
    ->Arg(20'000)
    ->Arg(1'000'000)
    ->Arg(10'000'000)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
