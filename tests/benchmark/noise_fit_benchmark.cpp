// Estimating the noise with the fit: restricted likelihood over the grid of shapes, for a magnetic
// test (75 rows), a day of it (400), a long record (2,000), and the whitening of 20,000 rows.

#include <benchmark/benchmark.h>

#include "model/fit/gls.hpp"

namespace {

using fogbench::model::Windows;

Windows windows_of(Eigen::Index rows) {
  Windows w;
  w.run_begin = {0, static_cast<std::size_t>(rows)};
  w.centre_s = Eigen::VectorXd::LinSpaced(rows, 90.0, 90.0 + 200.0 * static_cast<double>(rows - 1));
  w.duration_s = Eigen::VectorXd::Constant(rows, 180.0);
  w.white_floor = Eigen::VectorXd::Constant(rows, 0.0045);
  return w;
}

/// Any numbers will do: the work does not depend on them.
Eigen::MatrixXd columns_of(Eigen::Index rows, Eigen::Index columns) {
  Eigen::MatrixXd out(rows, columns);
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (Eigen::Index j = 0; j < columns; ++j) {
      out(i, j) = std::sin(static_cast<double>((i + 1) * (j + 1)));
    }
  }
  return out;
}

void BM_Gls(benchmark::State& state) {
  const Windows windows = windows_of(state.range(0));
  const Eigen::MatrixXd x = columns_of(state.range(0), 5);
  const Eigen::VectorXd y = columns_of(state.range(0), 6).col(5);
  for (auto _ : state) benchmark::DoNotOptimize(fogbench::model::gls(windows, x, y)->beta.data());
}
BENCHMARK(BM_Gls)->Arg(75)->Arg(400)->Arg(2000)->Unit(benchmark::kMillisecond);

/// As a search among candidates does it: the shapes are prepared once.
void BM_GlsOnKnownShapes(benchmark::State& state) {
  const auto shapes = fogbench::model::NoiseShapes::make(windows_of(state.range(0)));
  const Eigen::MatrixXd x = columns_of(state.range(0), 5);
  const Eigen::VectorXd y = columns_of(state.range(0), 6).col(5);
  for (auto _ : state) benchmark::DoNotOptimize(fogbench::model::gls(*shapes, x, y)->beta.data());
}
BENCHMARK(BM_GlsOnKnownShapes)->Arg(75)->Arg(400)->Arg(2000)->Unit(benchmark::kMillisecond);

void BM_Whiten(benchmark::State& state) {
  const Windows windows = windows_of(state.range(0));
  const Eigen::MatrixXd columns = columns_of(state.range(0), 10);
  for (auto _ : state) {
    const auto whitener = fogbench::model::make_whitener(windows, {0.001, 0.003, 0.003, 0.0});
    benchmark::DoNotOptimize((*whitener)->whiten(columns).data());
  }
}
BENCHMARK(BM_Whiten)->Arg(20000)->Unit(benchmark::kMillisecond);

}  // namespace
