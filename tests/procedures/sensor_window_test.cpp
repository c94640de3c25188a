#include "procedures/sensor_window.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace fogbench::procedures {
namespace {

constexpr double kStartS = 100.0, kEndS = 160.0, kDurationS = kEndS - kStartS;

/// A sensor with a first-order lag that follows `truth` from time 0, read once a second.
SensorWindow watch(const std::function<double(double)>& truth, double true_lag_s,
                   double corrected_lag_s, double noise = 0.0, double last_s = 170.0,
                   std::uint64_t seed = 1) {
  constexpr double kStepS = 0.01;
  SensorWindow window(kStartS, kEndS, corrected_lag_s);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  double reading = truth(0.0);
  for (int i = 0; i <= std::lround(last_s / kStepS); ++i) {
    const double t = i * kStepS;
    if (i % 100 == 30) window.add(t, reading + noise * normal(random));
    const double follow = true_lag_s > 0.0 ? -std::expm1(-kStepS / true_lag_s) : 1.0;
    reading += follow * (truth(t + kStepS) - reading);
  }
  return window;
}

/// A rate of 50 degC/h that sets in at `begin_s` through the heater's own 15 s.
std::function<double(double)> heated_from(double begin_s) {
  return [begin_s](double t) {
    constexpr double kHeaterS = 15.0;
    const double since = t - begin_s;
    return since <= 0.0 ? 31.0
                        : 31.0 + 50.0 / 3600.0 * (since + kHeaterS * std::expm1(-since / kHeaterS));
  };
}

double true_mean(const std::function<double(double)>& truth) {
  double sum = 0.0;
  constexpr int kSteps = 6000;
  for (int i = 0; i < kSteps; ++i) sum += truth(kStartS + (i + 0.5) * kDurationS / kSteps);
  return sum / kSteps;
}

TEST(SensorWindow, KnowsMeanAndRateOfARampThatItsSensorFollowsLate) {
  const auto ramp = [](double t) { return 21.0 + 0.014 * t; };
  const SensorWindow window = watch(ramp, 10.0, 10.0);
  EXPECT_NEAR(window.mean(), ramp(130.0), 1e-4);
  EXPECT_NEAR(window.start(), ramp(kStartS), 1e-4);
  EXPECT_NEAR(window.end(), ramp(kEndS), 1e-4);
  EXPECT_NEAR(window.rate_per_s(), 0.014, 1e-6);
  EXPECT_NEAR(watch(ramp, 10.0, 0.0).mean(), ramp(120.0), 1e-4);  // what it cures
}

TEST(SensorWindow, KnowsMeanAndRateWhereverInItTheHeatingSetsIn) {
  for (double begin = 60.0; begin < kEndS; begin += 5.0) {
    const auto truth = heated_from(begin);
    const SensorWindow window = watch(truth, 10.0, 10.0);
    const double rate = (truth(kEndS) - truth(kStartS)) / kDurationS;
    EXPECT_NEAR(window.mean(), true_mean(truth), 0.001) << begin;
    // Of the ramp's 50 degC/h.
    EXPECT_NEAR(window.rate_per_s() * 3600.0, rate * 3600.0, 0.75) << begin;
  }
}

TEST(SensorWindow, KnowsTheMeanRateWithoutLagToo) {
  for (double begin = 60.0; begin < kEndS; begin += 5.0) {
    const auto truth = heated_from(begin);
    const double rate = (truth(kEndS) - truth(kStartS)) / kDurationS;
    EXPECT_NEAR(watch(truth, 0.0, 0.0).rate_per_s() * 3600.0, rate * 3600.0, 0.5) << begin;
  }
}

TEST(SensorWindow, HardlyAmplifiesTheSensorsNoise) {
  // An approach to a set point: curved, but no more than a line with two halves can follow.
  const auto truth = [](double t) { return 31.0 - 0.5 * std::exp(-t / 400.0); };
  const double mean = true_mean(truth);
  const double rate = (truth(kEndS) - truth(kStartS)) / kDurationS;
  constexpr double kNoiseC = 0.0014;
  double mean_squares = 0.0, rate_squares = 0.0;
  constexpr int kSeeds = 200;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const SensorWindow window = watch(truth, 10.0, 10.0, kNoiseC, 170.0, seed);
    mean_squares += std::pow(window.mean() - mean, 2) / kSeeds;
    rate_squares += std::pow((window.rate_per_s() - rate) * 3600.0, 2) / kSeeds;
  }
  // The plain mean of 60 readings: 0.0014/sqrt(60) = 0.0002; the plain slope: 0.04 degC/h.
  EXPECT_LT(std::sqrt(mean_squares), 0.0003);
  EXPECT_LT(std::sqrt(rate_squares), 0.08);
}

TEST(SensorWindow, ManagesWithoutReadingsAfterItsEnd) {
  const auto ramp = [](double t) { return 21.0 + 0.014 * t; };
  const SensorWindow window = watch(ramp, 10.0, 10.0, 0.0, kEndS);
  EXPECT_NEAR(window.mean(), ramp(130.0), 1e-4);
  EXPECT_NEAR(window.rate_per_s(), 0.014, 1e-6);
}

TEST(SensorWindow, FallsBackOnTheWholeWindowWhereAnEndIsBlind) {
  SensorWindow window(kStartS, kEndS, 10.0);
  for (double t = 110.0; t <= 140.0; t += 1.0) window.add(t, 31.0 + 0.01 * t);
  EXPECT_EQ(window.count(), 31U);
  EXPECT_NEAR(window.rate_per_s(), 0.01, 1e-9);
  EXPECT_NEAR(window.mean(), 31.0 + 0.01 * 140.0, 1e-9);  // read 10 s late
}

TEST(SensorWindow, IsNotANumberWithoutReadings) {
  SensorWindow window(kStartS, kEndS, 10.0);
  EXPECT_TRUE(std::isnan(window.mean()));
  EXPECT_TRUE(std::isnan(window.rate_per_s()));
  window.add(130.0, std::nan(""));
  EXPECT_EQ(window.count(), 0U);
}

TEST(SensorWindow, TakesASingleReadingForTheMeanWhereNothingLags) {
  SensorWindow window(kStartS, kEndS, 0.0);
  window.add(130.0, 31.5);
  EXPECT_DOUBLE_EQ(window.mean(), 31.5);
}

}  // namespace
}  // namespace fogbench::procedures
