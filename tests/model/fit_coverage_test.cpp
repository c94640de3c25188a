// Whether the expanded uncertainties that a fit states hold the truth as often as they say:
// 95.45 %, over many simulated sessions with known coefficients and inner parameters.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "model/fit/fit.hpp"
#include "model/fit/predict.hpp"
#include "tests/model/models.hpp"

namespace fogbench::model {
namespace {

constexpr int kSessions = 1000;
constexpr unsigned kFirstSeed = 20'000;

/// An hour of one-minute averages after power-on, at three temperatures.
Table heated_session() {
  std::vector<double> time, duration, temperature;
  for (int i = 0; i < 60; ++i) {
    time.push_back(30.0 + 60.0 * i);
    duration.push_back(60.0);
    temperature.push_back(31.0 + 10.0 * (i / 20));
  }
  Table table;
  table.set_column("time_s", time);
  table.set_column("duration_s", duration);
  table.set_column("temperature_c", temperature);
  return table;
}

TEST(FitCoverage, ExpandedUncertaintyHoldsTheTruthAsOftenAsItSays) {
  config::ModelFile truth;
  truth.terms = {term("bias", 0.7), term("temperature_linear", 0.02), term("warm_up", 0.8)};
  truth.terms[2].parameters = {{"tau", 600.0}};
  const std::vector<double> expected = {0.7, 0.02, 0.8, 600.0};
  config::ModelFile model = truth;
  for (config::ModelTerm& t : model.terms) {
    t.coefficient.reset();
    t.parameters.clear();
  }
  Table table = heated_session();
  const auto clean = predict(table, truth);
  ASSERT_TRUE(clean) << clean.error().message;
  std::vector<int> held(expected.size(), 0);
  for (int i = 0; i < kSessions; ++i) {
    std::mt19937_64 random(kFirstSeed + static_cast<unsigned>(i));
    std::normal_distribution<double> noise(0.0, 0.02);
    std::vector<double> rate;
    for (const double value : *clean) rate.push_back(value + noise(random));
    table.set_column("rate_deg_per_h", rate);
    const auto found = fit(table, model, {.noise = FitOptions::Noise::kIndependent});
    ASSERT_TRUE(found) << found.error().message;
    for (std::size_t k = 0; k < expected.size(); ++k) {
      const Estimate& e = found->estimates[k];
      held[k] += std::abs(e.value - expected[k]) <= e.coverage_factor * e.standard_error ? 1 : 0;
    }
  }
  // Three standard deviations of a count of 1000 at 95.45 % are 2 %; the linearisation of tau may
  // take another half.
  for (std::size_t k = 0; k < expected.size(); ++k) {
    const double share = held[k] / static_cast<double>(kSessions);
    RecordProperty("covered_" + std::to_string(k), std::to_string(share));
    EXPECT_NEAR(share, 0.9545, 0.025) << "estimate " << k;
  }
}

}  // namespace
}  // namespace fogbench::model
