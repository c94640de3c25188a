// How often the diagnosis is right, on a sample of the study (tests/benchmark/diagnosis_study.cpp)
// small enough to run with every change. Seeds are fixed, so a failure is a change of the engine.
// Each bound is what a sample of this size reaches with 99 % when the rate is the one stated.

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "tests/support/diagnosis_trial.hpp"

namespace fogbench::tests {
namespace {

/// The largest count that `trials` of a chance `rate` stay within in 99 % of cases.
int most_of(int trials, double rate) {
  double term = std::pow(1.0 - rate, trials), sum = term;
  int count = 0;
  while (sum < 0.99 && count < trials) {
    term *= static_cast<double>(trials - count) / (count + 1) * rate / (1.0 - rate);
    sum += term;
    ++count;
  }
  return count;
}

/// Asks each case `each` times; says what was not `good`; the number of those.
template <class Good>
int misses(const std::vector<DiagnosisCase>& cases, int each, const Good& good) {
  TrialMaker maker;
  int count = 0;
  for (const DiagnosisCase& what : cases) {
    for (int i = 0; i < each; ++i) {
      const Answer answer = answer_of(maker.make(what, static_cast<std::uint64_t>(i)));
      const Outcome outcome = judge(answer, what.hidden);
      if (good(outcome)) continue;
      ++count;
      std::cout << what.name() << " #" << i << ": " << name_of(outcome) << ", " << answer.says
                << '\n';
    }
  }
  return count;
}

bool named(Outcome outcome) {
  return outcome == Outcome::kRight || outcome == Outcome::kRightInSet;
}

bool flagged(Outcome outcome) {
  return outcome == Outcome::kUnexplained || outcome == Outcome::kHedged;
}

TEST(DiagnosisRates, NoiseAloneIsRarelyTakenForAnEffect) {
  std::vector<DiagnosisCase> cases;
  for (const char* noise : {"white", "flicker", "walk", "navigation", "fractional", "tails"}) {
    cases.push_back({.part = "rates", .design = Design::kMagnetic, .noise = noise});
  }
  constexpr int kEach = 6;
  EXPECT_LE(misses(cases, kEach, [](Outcome o) { return o == Outcome::kAdequate; }),
            most_of(kEach * static_cast<int>(cases.size()), 0.05));
}

TEST(DiagnosisRates, OneEffectIsNamed) {
  std::vector<DiagnosisCase> cases;
  for (const char* id : {"magnetic_quadratic_x", "magnetic_saturation_z", "magnetic_hysteresis_y",
                         "magnetic_settling_z", "coil_heating", "drift_linear"}) {
    cases.push_back({.part = "rates", .design = Design::kMagnetic, .hidden = {id}, .s = 12.0});
  }
  for (const char* id : {"temperature_quadratic", "temperature_rate_lagged"}) {
    cases.push_back({.part = "rates", .design = Design::kThermal, .hidden = {id}, .s = 12.0});
  }
  constexpr int kEach = 2;
  EXPECT_LE(misses(cases, kEach, named), most_of(kEach * static_cast<int>(cases.size()), 0.05));
}

TEST(DiagnosisRates, TwoEffectsAreBothNamed) {
  const std::vector<DiagnosisCase> cases{
      {.part = "rates",
       .design = Design::kMagnetic,
       .hidden = {"magnetic_hysteresis_z", "magnetic_quadratic_x"},
       .s = 16.0},
      {.part = "rates",
       .design = Design::kMagnetic,
       .hidden = {"magnetic_saturation_x", "magnetic_settling_z"},
       .s = 16.0}};
  constexpr int kEach = 3;
  EXPECT_LE(misses(cases, kEach, named), most_of(kEach * static_cast<int>(cases.size()), 0.1));
}

TEST(DiagnosisRates, WhatTheCatalogueDoesNotHoldIsSaidToBeSo) {
  std::vector<DiagnosisCase> cases;
  for (const char* id : {"outside_sqrt_field_z", "outside_direction_cube_y", "outside_sine_field_z",
                         "outside_pulse"}) {
    cases.push_back({.part = "rates", .design = Design::kMagnetic, .hidden = {id}, .s = 16.0});
  }
  constexpr int kEach = 2;
  EXPECT_LE(misses(cases, kEach, flagged), most_of(kEach * static_cast<int>(cases.size()), 0.05));
}

TEST(DiagnosisRates, ALoopThatRelaxesIsStillHysteresis) {
  const std::vector<DiagnosisCase> cases{{.part = "rates",
                                          .design = Design::kMagnetic,
                                          .hidden = {"magnetic_hysteresis_z"},
                                          .shape = Shape::kOther,
                                          .s = 20.0}};
  constexpr int kEach = 3;
  EXPECT_LE(misses(cases, kEach, named), most_of(kEach, 0.1));
}

}  // namespace
}  // namespace fogbench::tests
