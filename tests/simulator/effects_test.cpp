// Each effect's regressor against values worked out by hand.

#include "simulator/effects/effect.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "simulator/hidden_effects.hpp"

namespace fogbench::simulator {
namespace {

/// The rate that one effect of amplitude 1 adds.
class Effect {
 public:
  explicit Effect(const std::string& id, std::map<std::string, double> parameters = {})
      : effects_(*HiddenEffects::create({.hidden = {{id, 1.0, std::move(parameters)}}})) {}
  double operator()(const TrueState& state) { return effects_.advance(state); }

 private:
  HiddenEffects effects_;
};

TrueState state_at(double time_s) {
  TrueState s;
  s.step_s = 0.1;
  s.time_s = time_s;
  s.reference_temperature_c = 21.0;
  s.temperature_c = 31.0;
  s.temperature_rate_c_per_h = 6.0;
  s.temperature_acceleration_c_per_h2 = -2.5;
  s.temperature_gradient_c = 0.4;
  s.heater_w = 7.5;
  s.ambient_c = 22.5;
  s.field_100ut = {0.5, -2.0, 3.0};
  s.sum_squared_current_a2 = 4.0;
  s.azimuth_deg = 60.0;
  return s;
}

TEST(Effects, WithoutMemoryAreWhatTheirFormulasSay) {
  const TrueState s = state_at(1800.0);
  EXPECT_DOUBLE_EQ(Effect("bias")(s), 1.0);
  EXPECT_DOUBLE_EQ(Effect("drift_linear")(s), 0.5);
  EXPECT_DOUBLE_EQ(Effect("warm_up", {{"tau", 900.0}})(s), std::exp(-2.0));
  EXPECT_DOUBLE_EQ(Effect("temperature_linear")(s), 10.0);
  EXPECT_DOUBLE_EQ(Effect("temperature_quadratic")(s), 100.0);
  EXPECT_DOUBLE_EQ(Effect("temperature_cubic")(s), 1000.0);
  EXPECT_DOUBLE_EQ(Effect("temperature_rate")(s), 6.0);
  EXPECT_DOUBLE_EQ(Effect("temperature_acceleration")(s), -2.5);
  EXPECT_DOUBLE_EQ(Effect("temperature_rate_cross")(s), 60.0);
  EXPECT_DOUBLE_EQ(Effect("temperature_gradient")(s), 0.4);
  EXPECT_DOUBLE_EQ(Effect("heater_power")(s), 7.5);
  EXPECT_DOUBLE_EQ(Effect("ambient_temperature")(s), 1.5);
  EXPECT_DOUBLE_EQ(Effect("magnetic_linear_x")(s), 0.5);
  EXPECT_DOUBLE_EQ(Effect("magnetic_linear_y")(s), -2.0);
  EXPECT_DOUBLE_EQ(Effect("magnetic_linear_z")(s), 3.0);
  EXPECT_DOUBLE_EQ(Effect("magnetic_quadratic_x")(s), 0.25);
  EXPECT_DOUBLE_EQ(Effect("magnetic_quadratic_y")(s), 4.0);
  EXPECT_DOUBLE_EQ(Effect("magnetic_quadratic_z")(s), 9.0);
  EXPECT_DOUBLE_EQ(Effect("magnetic_cross_xy")(s), -1.0);
  EXPECT_DOUBLE_EQ(Effect("magnetic_cross_yz")(s), -6.0);
  EXPECT_DOUBLE_EQ(Effect("magnetic_cross_zx")(s), 1.5);
  EXPECT_DOUBLE_EQ(Effect("magnetic_saturation_x", {{"hs", 0.5}})(s), std::tanh(1.0));
  EXPECT_DOUBLE_EQ(Effect("magnetic_saturation_y", {{"hs", 4.0}})(s), std::tanh(-0.5));
  EXPECT_DOUBLE_EQ(Effect("magnetic_saturation_z", {{"hs", 3.0}})(s), std::tanh(1.0));
  EXPECT_DOUBLE_EQ(Effect("magnetic_temperature_x")(s), 5.0);
  EXPECT_DOUBLE_EQ(Effect("magnetic_temperature_y")(s), -20.0);
  EXPECT_DOUBLE_EQ(Effect("magnetic_temperature_z")(s), 30.0);
  EXPECT_DOUBLE_EQ(Effect("magnetic_temperature_rate_x")(s), 3.0);
  EXPECT_DOUBLE_EQ(Effect("magnetic_temperature_rate_y")(s), -12.0);
  EXPECT_DOUBLE_EQ(Effect("magnetic_temperature_rate_z")(s), 18.0);
}

TEST(Effects, TheGradientsRateIsItsChangeSinceTheStepBefore) {
  Effect rate("temperature_gradient_rate");
  TrueState s = state_at(0.1);
  EXPECT_NEAR(rate(s), 0.4 / 0.1 * 3600.0, 1e-9);
  EXPECT_EQ(rate(s), 0.0);
  s.temperature_gradient_c = 0.3;
  EXPECT_NEAR(rate(s), -0.1 / 0.1 * 3600.0, 1e-9);
}

TEST(Effects, BiasStepBeginsAtItsTime) {
  Effect step("bias_step", {{"t0", 100.0}});
  EXPECT_EQ(step(state_at(99.9)), 0.0);
  EXPECT_EQ(step(state_at(100.0)), 1.0);
  EXPECT_EQ(step(state_at(5000.0)), 1.0);
}

TEST(Effects, PeriodicEffectsTakeAPhase) {
  const TrueState s = state_at(0.0);  // 31 degC, azimuth 60 deg
  EXPECT_NEAR(Effect("earth_rate_projection")(s), 0.5, 1e-12);
  EXPECT_NEAR(Effect("earth_rate_projection", {{"phase_deg", 90.0}})(s), std::sqrt(0.75), 1e-12);
  EXPECT_NEAR(Effect("temperature_ripple", {{"period", 4.0}})(s), 0.0, 1e-12);
  EXPECT_NEAR(Effect("temperature_ripple", {{"period", 4.0}, {"phase_deg", -90.0}})(s), 1.0, 1e-12);
}

TEST(Effects, LaggedEffectsFollowAStepExponentially) {
  Effect rate("temperature_rate_lagged", {{"tau", 50.0}});
  Effect heating("coil_heating", {{"tau", 100.0}});
  double lagged_rate = 0.0;
  double heat = 0.0;
  for (int i = 0; i < 1000; ++i) {
    lagged_rate = rate(state_at(0.1 * i));
    heat = heating(state_at(0.1 * i));
  }
  EXPECT_NEAR(lagged_rate, 6.0 * (1.0 - std::exp(-2.0)), 1e-9);
  EXPECT_NEAR(heat, 4.0 * (1.0 - std::exp(-1.0)), 1e-9);
}

TEST(Effects, SettlingIsEachStepOfTheFieldDyingAway) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Effect settling(std::string("magnetic_settling_") + "xyz" [axis], {
      { "tau", 20.0 }
    });
    TrueState s = state_at(0.0);
    EXPECT_EQ(settling(s), 0.0);  // The field at power-on has been there for long.
    s.field_100ut[axis] += 1.5;
    double value = 0.0;
    for (int i = 0; i < 200; ++i) value = settling(s);
    EXPECT_NEAR(value, 1.5 * std::exp(-1.0), 1e-9);
  }
}

TEST(Effects, HysteresisIsPlayWithoutHistoryAtTheStart) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Effect play(std::string("magnetic_hysteresis_") + "xyz" [axis], {
      { "width", 0.6 }
    });
    TrueState s = state_at(0.0);
    const auto at = [&](double h) {
      s.field_100ut[axis] = h;
      return play(s);
    };
    EXPECT_DOUBLE_EQ(at(0.5), 0.0);
    EXPECT_DOUBLE_EQ(at(3.0), 2.4);
    EXPECT_DOUBLE_EQ(at(2.0), 2.4);
    EXPECT_DOUBLE_EQ(at(0.0), 0.6);
    EXPECT_DOUBLE_EQ(at(-3.0), -2.4);
    EXPECT_DOUBLE_EQ(at(0.0), -0.6);
  }
  Effect thermal("temperature_hysteresis", {{"width", 2.0}});
  TrueState s = state_at(0.0);
  EXPECT_DOUBLE_EQ(thermal(s), 8.0);
  s.temperature_c = 28.0;
  EXPECT_DOUBLE_EQ(thermal(s), 8.0);
  s.temperature_c = 25.0;
  EXPECT_DOUBLE_EQ(thermal(s), 6.0);
}

TEST(Effects, HaveOneNameEach) {
  std::set<std::string> found;
  for (const EffectEntry& entry : all_effects()) EXPECT_TRUE(found.insert(entry.id).second);
  EXPECT_GE(found.size(), 40U);
}

TEST(Effects, OfAChannelAreNamedWithIt) {
  EXPECT_EQ(find_effect("sensitivity(supply_v)")->channel, "supply_v");
  EXPECT_EQ(find_effect("bias")->channel, "");
  for (const char* const wrong : {"sensitivity", "bias(supply_v)", "sensitivity(supply_v", ""}) {
    EXPECT_FALSE(find_effect(wrong)) << wrong;
  }
  Effect effect("sensitivity(supply_v)");
  TrueState s = state_at(0.0);
  EXPECT_EQ(effect(s), 0.0) << "nobody measures it";
  s.auxiliary["supply_v"] = -0.25;
  EXPECT_EQ(effect(s), -0.25);
}

TEST(HiddenEffects, AddTermsAndHiddenOnesEachWithItsAmplitude) {
  config::ScenarioConfig scenario;
  scenario.terms = {{"bias", 0.7}, {"magnetic_linear_z", -0.25}};
  scenario.hidden = {{"magnetic_quadratic_z", 0.1, {}}};
  HiddenEffects effects = *HiddenEffects::create(scenario);
  EXPECT_NEAR(effects.advance(state_at(0.0)), 0.7 - 0.75 + 0.9, 1e-12);
}

TEST(HiddenEffects, TheShieldsStateScalesTheMagneticEffectsAlone) {
  config::ScenarioConfig scenario;
  scenario.terms = {{"bias", 0.7}, {"magnetic_linear_z", -0.25}};
  scenario.magnetic_scale = {{config::Seconds{200.0}, 0.64}, {config::Seconds{100.0}, 0.8}};
  HiddenEffects effects = *HiddenEffects::create(scenario);
  EXPECT_NEAR(effects.advance(state_at(99.0)), 0.7 - 0.75, 1e-12);
  EXPECT_NEAR(effects.advance(state_at(150.0)), 0.7 - 0.75 * 0.8, 1e-12);
  EXPECT_NEAR(effects.advance(state_at(200.0)), 0.7 - 0.75 * 0.64, 1e-12);
}

struct BadScenario {
  const char* says;
  config::ScenarioConfig scenario;
};

TEST(HiddenEffects, EverythingUnknownMissingOrImpossibleIsNamed) {
  const std::vector<BadScenario> cases = {
      {"/hidden/0: unknown effect \"magnetic_hysterisis_z\"; did you mean "
       "\"magnetic_hysteresis_z\"?",
       {.hidden = {{"magnetic_hysterisis_z", 0.1, {{"width", 0.6}}}}}},
      {"/gyro/terms/biass: unknown effect \"biass\"; did you mean \"bias\"?",
       {.terms = {{"biass", 0.7}}}},
      {"/gyro/terms/warm_up: warm_up needs the parameter \"tau\"", {.terms = {{"warm_up", 0.7}}}},
      {"unknown parameter of warm_up \"taus\"; did you mean \"tau\"?",
       {.hidden = {{"warm_up", 0.1, {{"tau", 1.0}, {"taus", 0.6}}}}}},
      {"unknown parameter of bias \"tau\"; it takes none", {.hidden = {{"bias", 1, {{"tau", 1}}}}}},
      {"tau is 0, expected a number above 0", {.hidden = {{"warm_up", 0.1, {{"tau", 0.0}}}}}},
      {"width is -1, expected a number not below 0",
       {.hidden = {{"temperature_hysteresis", 0.1, {{"width", -1.0}}}}}},
      {"t0 is nan, expected a finite number",
       {.hidden = {{"bias_step", 0.1, {{"t0", std::nan("")}}}}}},
      {"the amplitude of bias is not a finite number", {.hidden = {{"bias", std::nan(""), {}}}}},
  };
  for (const BadScenario& bad : cases) {
    const auto effects = HiddenEffects::create(bad.scenario);
    ASSERT_FALSE(effects) << bad.says;
    EXPECT_EQ(effects.error().code, ErrorCode::kBadInput);
    EXPECT_NE(effects.error().message.find(bad.says), std::string::npos) << effects.error().message;
  }
}

}  // namespace
}  // namespace fogbench::simulator
