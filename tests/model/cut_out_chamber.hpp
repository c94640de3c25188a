#pragma once
// Tables of a temperature chamber that are cut out of longer ones: the memories of what they hold
// are older than their first row.

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <utility>
#include <vector>

#include "model/fit/fit.hpp"
#include "model/fit/predict.hpp"
#include "tests/model/models.hpp"

namespace fogbench::model {

inline constexpr double kChamberWindow_s = 90.0;

/// Temperatures that rise and fall between plateaus, `hours` long; one row a window.
inline Table chamber(double hours) {
  // Minutes at which a ramp ends, and where.
  constexpr std::pair<double, double> kCorners[] = {
      {0, 22},   {35, 43},  {60, 43},  {95, 27},  {125, 27}, {160, 47}, {190, 47}, {240, 19},
      {270, 19}, {310, 38}, {340, 38}, {370, 25}, {400, 25}, {440, 44}, {470, 44}};
  const auto temperature = [&](double minutes) {
    for (std::size_t i = 1; i < std::size(kCorners); ++i) {
      const auto [to, high] = kCorners[i];
      const auto [from, low] = kCorners[i - 1];
      if (minutes <= to) return low + (high - low) * (minutes - from) / (to - from);
    }
    return kCorners[std::size(kCorners) - 1].second;
  };
  std::vector<double> time, duration, mean, rate;
  for (double at = 0.0; at < 3600.0 * hours; at += kChamberWindow_s) {
    const double begin = temperature(at / 60.0), end = temperature((at + kChamberWindow_s) / 60.0);
    time.push_back(at + kChamberWindow_s / 2.0);
    duration.push_back(kChamberWindow_s);
    mean.push_back((begin + 4.0 * temperature((at + kChamberWindow_s / 2.0) / 60.0) + end) / 6.0);
    rate.push_back((end - begin) / kChamberWindow_s * 3600.0);
  }
  Table table;
  table.set_column("time_s", time);
  table.set_column("duration_s", duration);
  table.set_column("temperature_c", mean);
  table.set_column("temperature_rate_c_per_h", rate);
  return table;
}

/// The table's rows from `first` on, without those between `from` and `to`.
inline Table rows_of(const Table& table, std::size_t first, std::size_t from = 0,
                     std::size_t to = 0) {
  std::vector<bool> keep(table.rows());
  for (std::size_t row = first; row < keep.size(); ++row) keep[row] = row < from || row >= to;
  return table.select(keep);
}

inline config::ModelTerm term_of(std::string effect, double coefficient, std::string inner,
                                 double value) {
  config::ModelTerm out = term(std::move(effect), coefficient);
  out.parameters = {{std::move(inner), value}};
  return out;
}

/// The rows from `first` on of a world that began long before, with white noise on the rate.
inline Table cut_out(const config::ModelFile& truth, double hours, std::size_t first, double sigma,
                     unsigned seed) {
  Table whole = chamber(hours);
  const auto clean = predict(whole, truth);
  EXPECT_TRUE(clean) << clean.error().message;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, sigma);
  std::vector<double> rate;
  for (const double value : *clean) rate.push_back(value + noise(random));
  whole.set_column("rate_deg_per_h", rate);
  whole.set_column("rate_std_error_deg_per_h", std::vector<double>(rate.size(), sigma));
  return rows_of(whole, first);
}

inline config::ModelFile lagged_world() {
  return model_of({term("bias", 0.4), term("temperature_linear", 0.003),
                   term_of("temperature_rate_lagged", 0.017, "tau", 800.0)});
}

inline config::ModelFile play_world(double width) {
  return model_of({term("bias", 0.4), term("temperature_linear", 0.003),
                   term_of("temperature_hysteresis", 0.08, "width", width)});
}

}  // namespace fogbench::model
