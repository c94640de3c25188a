// Reading a measurement table, and fitting a model to it: a fit of a long table is to be limited by
// reading it.

#include <benchmark/benchmark.h>
#include <fast_float/fast_float.h>
#include <fmt/format.h>
#include <unistd.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "model/fit/fit.hpp"
#include "model/table/read_table.hpp"

namespace fogbench::model {
namespace {

constexpr int kRows = 1'000'000;

/// A million samples of five columns, 0.1 s each.
class LongTable {
 public:
  LongTable()
      : path_(std::filesystem::temp_directory_path() /
              fmt::format("fogbench-table-{}.csv", getpid())) {
    std::string text = "time_s,duration_s,temperature_c,field_z_ut,rate_deg_per_h\n";
    std::uint64_t state = 1;  // a plain congruential generator: only the digits matter
    for (int i = 0; i < kRows; ++i) {
      state = state * 6364136223846793005U + 1442695040888963407U;
      const double noise = static_cast<double>(state >> 40) / (1 << 24) - 0.5;
      const double t = 35.0 + 10.0 * std::sin(1e-5 * i);
      const double h = 300.0 * std::sin(1e-4 * i);
      fmt::format_to(std::back_inserter(text), "{:.1f},0.1,{:.4f},{:.3f},{:.7f}\n", 0.1 * i, t, h,
                     0.7 - 0.01 * t - 0.0025 * h + 0.4 * noise);
    }
    bytes_ = text.size();
    std::ofstream(path_) << text;
  }
  ~LongTable() { std::filesystem::remove(path_); }
  LongTable(const LongTable&) = delete;
  LongTable& operator=(const LongTable&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::size_t bytes() const { return bytes_; }

 private:
  std::filesystem::path path_;
  std::size_t bytes_ = 0;
};

const LongTable& long_table() {
  static const LongTable table;
  return table;
}

config::ModelFile model() {
  config::ModelFile file;
  for (const char* effect :
       {"bias", "temperature_linear", "temperature_quadratic", "magnetic_linear_z"}) {
    file.terms.emplace_back().effect = effect;
  }
  return file;
}

void read_whole_table(benchmark::State& state) {
  for (auto _ : state) {
    auto table = read_table(long_table().path());
    if (!table) state.SkipWithError(table.error().message.c_str());
    benchmark::DoNotOptimize(table);
  }
  state.SetItemsProcessed(state.iterations() * kRows);
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(long_table().bytes()));
}
BENCHMARK(read_whole_table)->Unit(benchmark::kMillisecond);

/// What the disk, or the memory that keeps its pages, gives at most.
void read_bytes(benchmark::State& state) {
  std::vector<char> buffer(std::size_t{1} << 18);
  for (auto _ : state) {
    std::ifstream in(long_table().path(), std::ios::binary);
    while (in.read(buffer.data(), static_cast<std::streamsize>(buffer.size()))) {
      benchmark::DoNotOptimize(buffer.data());
    }
  }
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(long_table().bytes()));
}
BENCHMARK(read_bytes)->Unit(benchmark::kMillisecond);

/// The numbers alone, nothing looked for and nothing kept: what a reader of text can reach.
template <class Read>
void read_numbers(benchmark::State& state, Read read) {
  std::ifstream in(long_table().path(), std::ios::binary);
  std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  const char* const first = text.data() + text.find('\n') + 1;
  const char* const end = text.data() + text.size();
  for (auto _ : state) {
    double sum = 0.0;
    for (const char* at = first; at < end; ++at) {
      double value = 0.0;
      at = read(at, end, value);
      sum += value;
    }
    benchmark::DoNotOptimize(sum);
  }
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(end - first));
}
BENCHMARK_CAPTURE(read_numbers, std_from_chars, [](const char* at, const char* end, double& value) {
  return std::from_chars(at, end, value).ptr;
})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read_numbers, fast_float, [](const char* at, const char* end, double& value) {
  return fast_float::from_chars(at, end, value).ptr;
})->Unit(benchmark::kMillisecond);

void fit_table(benchmark::State& state, FitOptions::Noise noise) {
  const auto table = read_table(long_table().path());
  if (!table) {
    state.SkipWithError(table.error().message.c_str());
    return;
  }
  for (auto _ : state) {
    auto result = fit(*table, model(), {.noise = noise});
    if (!result) state.SkipWithError(result.error().message.c_str());
    benchmark::DoNotOptimize(result);
  }
  state.SetItemsProcessed(state.iterations() * kRows);
}
BENCHMARK_CAPTURE(fit_table, independent, FitOptions::Noise::kIndependent)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(fit_table, coloured, FitOptions::Noise::kColoured)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace fogbench::model
