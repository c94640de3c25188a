// The loop of real iron, which one play does not describe, is one effect: named, with remanence and
// coercive field, and what is left is noise. Its physics here are Preisach's relays, not plays.
// Seeds are fixed.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "model/diagnose/diagnose.hpp"
#include "model/diagnose/verdict_text.hpp"
#include "tests/model/models.hpp"

namespace fogbench::model {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr double kNearTheFloor = 1.6;
constexpr double kRemanence = 0.015;  // deg/h

/// Relays whose coercive and interaction inputs are spread about `coercive` (log-normal, by
/// `spread`) and about `centre` (normal, by `interaction`).
struct Iron {
  double coercive, spread, interaction, centre = 0.0;
};

/// From one turning point to the next in steps of `step`.
std::vector<double> driven(const std::vector<double>& turns, double step) {
  std::vector<double> out{turns.front()};
  for (std::size_t i = 1; i < turns.size(); ++i) {
    const double way = turns[i] - turns[i - 1];
    const long steps = std::lround(std::abs(way) / step);
    for (long k = 1; k <= steps; ++k) {
      out.push_back(turns[i - 1] + way * static_cast<double>(k) / static_cast<double>(steps));
    }
  }
  return out;
}

/// The magnetisation, -1 ... 1, of demagnetised iron on its way through `input`.
std::vector<double> magnetised(const Iron& iron, const std::vector<double>& input) {
  constexpr int kEach = 100;
  constexpr double kReach = 3.5;
  struct Relay {
    double up, down, weight;
    bool on;
  };
  std::vector<Relay> relays;
  double all = 0.0;
  for (int i = 0; i < kEach; ++i) {
    for (int j = 0; j < kEach; ++j) {
      const double a = kReach * (2.0 * (i + 0.5) / kEach - 1.0);
      const double b = kReach * (2.0 * (j + 0.5) / kEach - 1.0);
      const double half = iron.coercive * std::exp(iron.spread * a);
      const double middle = iron.centre + iron.interaction * b;
      relays.push_back({middle + half, middle - half, std::exp(-0.5 * (a * a + b * b)), b < 0.0});
      all += relays.back().weight;
    }
  }
  std::vector<double> out;
  for (const double u : input) {
    double sum = 0.0;
    for (Relay& relay : relays) {
      if (u >= relay.up) relay.on = true;
      if (u <= relay.down) relay.on = false;
      sum += relay.on ? relay.weight : -relay.weight;
    }
    out.push_back(sum / all);
  }
  return out;
}

/// Windows of 180 s at the values of `input`: bias, a slope, `extra` and white noise.
Table measured(const std::string& column, const std::vector<double>& input,
               const std::vector<double>& extra, double slope, double noise, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<> normal;
  std::vector<double> time, rate;
  for (std::size_t i = 0; i < input.size(); ++i) {
    time.push_back(100.0 + 200.0 * static_cast<double>(i));
    rate.push_back(0.7 + slope * input[i] + extra[i] + noise * normal(engine));
  }
  Table table;
  table.set_column("time_s", time);
  table.set_column("duration_s", std::vector<double>(input.size(), 180.0));
  table.set_column(column, input);
  table.set_column("rate_deg_per_h", rate);
  table.set_column("rate_std_error_deg_per_h", std::vector<double>(input.size(), noise));
  return table;
}

std::vector<double> times(double factor, std::vector<double> values) {
  for (double& value : values) value *= factor;
  return values;
}

const std::vector<double> kMajorLoop = {0, 300, -300, 0};
const std::vector<double> kSpiral = {0, 300, -300, 300, -250, 200, -150, 100, -50, 25, 0};

Diagnosis diagnosed(const Table& table, const std::string& linear) {
  auto d = diagnose(table, model_of_effects({"bias", linear}), {});
  EXPECT_TRUE(d) << (d ? "" : d.error().message);
  return d ? std::move(*d) : Diagnosis{};
}

Diagnosis diagnosed_field(const std::vector<double>& field, const std::vector<double>& extra,
                          double noise, unsigned seed) {
  return diagnosed(measured("field_z_ut", field, extra, -4e-4, noise, seed), "magnetic_linear_z");
}

/// One loop and nothing else, down to the noise.
void expect_a_loop(const Diagnosis& d, const std::string& effect, const std::string& form) {
  const std::string says = verdict_in_words(d, "").verdict;
  EXPECT_EQ(d.verdict, Verdict::kMissingEffect) << says;
  ASSERT_EQ(d.missing.size(), 1U) << says;
  EXPECT_EQ(d.missing[0].found.effect, effect);
  EXPECT_THAT(d.missing[0].terms.front(), StartsWith(form));
  EXPECT_LT(d.ladder.back().heldout_rms, kNearTheFloor * d.noise_floor);
  EXPECT_THAT(says, HasSubstr("a loop of remanence = "));
}

TEST(RealLoops, AMajorLoopWithMinorOnesIsOneEffectDownToTheNoise) {
  const std::vector<double> field = driven(kSpiral, 25.0);
  unsigned seed = 1;
  for (const Iron& iron : {Iron{60, 0.5, 80}, Iron{30, 0.8, 120}, Iron{100, 0.4, 60}}) {
    const std::vector<double> m = magnetised(iron, field);
    // The falling branch of the loop by itself.
    const std::vector<double> loop = magnetised(iron, driven({300, -300}, 1.0));
    for (const double noise : {0.00025, 0.0005}) {
      SCOPED_TRACE(testing::Message() << iron.coercive << " uT, noise " << noise);
      const Diagnosis d = diagnosed_field(field, times(kRemanence / loop[300], m), noise, seed++);
      expect_a_loop(d, "magnetic_hysteresis_z", "magnetic_saturating_loop_z(");
      if (d.missing.empty() || !d.missing[0].loop) continue;
      const LoopFigures& found = *d.missing[0].loop;
      EXPECT_NEAR(found.remanence.value, kRemanence, 0.05 * kRemanence);
      const auto zero = std::find_if(loop.begin(), loop.end(), [](double v) { return v < 0.0; });
      const double coercive = static_cast<double>(zero - loop.begin()) - 300.0;
      EXPECT_NEAR(found.coercive.value, coercive, 0.1 * coercive);
      EXPECT_EQ(found.coercive.unit, "uT");
    }
  }
}

TEST(RealLoops, ASparseMajorLoopIsNamedAlone) {
  const std::vector<double> field = driven(kMajorLoop, 50.0);
  const std::vector<double> m = magnetised({60, 0.5, 80}, field);
  const Diagnosis d = diagnosed_field(field, times(0.015, m), 0.0005, 11);
  ASSERT_FALSE(d.missing.empty()) << verdict_in_words(d, "").verdict;
  EXPECT_EQ(d.missing[0].found.effect, "magnetic_hysteresis_z") << verdict_in_words(d, "").verdict;
}

TEST(RealLoops, OneOfTheTemperatureToo) {
  const std::vector<double> t = driven({21, 55, 25, 55, 30, 50, 35, 45, 40}, 1.0);
  std::vector<double> loop(t.size(), 0.0);
  // Plays of many widths, which the form takes parts of.
  for (int k = 0; k < 40; ++k) {
    const double width = 0.2 * (k + 0.5);
    double state = 0.0;
    for (std::size_t i = 0; i < t.size(); ++i) {
      state = std::clamp(state, t[i] - 21.0 - width, t[i] - 21.0 + width);
      loop[i] += std::exp(-width / 4.0) * state / 40.0;
    }
  }
  const Diagnosis d = diagnosed(measured("temperature_c", t, times(0.01, loop), -2e-3, 0.0005, 21),
                                "temperature_linear");
  expect_a_loop(d, "temperature_hysteresis", "temperature_loop(");
  ASSERT_TRUE(!d.missing.empty() && d.missing[0].loop);
  EXPECT_EQ(d.missing[0].loop->coercive.unit, "degC");
}

TEST(RealLoops, ASinglePlayKeepsItsOneWidth) {
  const std::vector<double> field = driven(kSpiral, 25.0);
  std::vector<double> play;
  double state = 0.0;
  for (const double h : field) play.push_back(state = std::clamp(state, h - 60.0, h + 60.0));
  const Diagnosis d = diagnosed_field(field, times(2e-4, play), 0.0005, 31);
  EXPECT_EQ(d.verdict, Verdict::kMissingEffect) << verdict_in_words(d, "").verdict;
  ASSERT_EQ(d.missing.size(), 1U) << verdict_in_words(d, "").verdict;
  EXPECT_EQ(d.missing[0].terms.front(), "magnetic_hysteresis_z");
  ASSERT_EQ(d.missing[0].estimates.size(), 2U);
  const Estimate& width = d.missing[0].estimates[1];
  EXPECT_NEAR(width.value, 0.6, 2.0 * width.coverage_factor * width.standard_error);
  // What the two numbers say as those of a loop.
  ASSERT_TRUE(d.missing[0].loop);
  EXPECT_NEAR(d.missing[0].loop->remanence.value, 2e-4 * 60.0, 1e-3);
  EXPECT_NEAR(d.missing[0].loop->coercive.value, 60.0, 5.0);
}

TEST(RealLoops, NoiseAndASaturationAloneAreNone) {
  const std::vector<double> field = driven(kSpiral, 25.0);
  const Diagnosis nothing =
      diagnosed_field(field, std::vector<double>(field.size(), 0.0), 0.0005, 41);
  EXPECT_EQ(nothing.verdict, Verdict::kNothingMissing) << verdict_in_words(nothing, "").verdict;
  std::vector<double> saturation;
  for (const double h : field) saturation.push_back(0.02 * std::tanh(h / 120.0));
  const Diagnosis bent = diagnosed_field(field, saturation, 0.0005, 42);
  ASSERT_EQ(bent.missing.size(), 1U) << verdict_in_words(bent, "").verdict;
  EXPECT_EQ(bent.missing[0].terms.front(), "magnetic_saturation_z");
}

}  // namespace
}  // namespace fogbench::model
