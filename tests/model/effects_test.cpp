// Each effect's regressor against values worked out by hand.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "model/effects/catalogue.hpp"

namespace fogbench::model {
namespace {

using testing::DoubleEq;
using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;

/// Five windows of 60 s every 100 s, fields and temperatures that tell the axes apart.
Table five_rows() {
  Table table;
  table.set_column("time_s", {100, 200, 300, 400, 500});
  table.set_column("duration_s", {60, 60, 60, 60, 60});
  table.set_column("temperature_c", {21, 31, 41, 36, 26});
  table.set_column("temperature_rate_c_per_h", {0, 360, 360, -180, -360});
  table.set_column("temperature_gradient_c", {0.1, 0.2, 0.3, 0.4, 0.5});
  table.set_column("ambient_c", {21, 22, 23, 24, 25});
  table.set_column("heater_w", {0, 12, 9, 0, 6});
  table.set_column("field_x_ut", {0, 100, 200, 100, -100});
  table.set_column("field_y_ut", {50, 0, 50, 0, 50});
  table.set_column("field_z_ut", {0, 0, 100, 100, -200});
  table.set_column("azimuth_deg", {0, 90, 180, 270, 30});
  return table;
}

std::vector<double> regressor(const std::string& id, std::vector<double> inner = {},
                              const Table& table = five_rows(), Eigen::Index column = 0) {
  const Signals signals(table, 21.0);
  const Effect* effect = find_effect(id);
  if (effect == nullptr) {
    ADD_FAILURE() << "no effect " << id;
    return {};
  }
  EXPECT_THAT(signals.missing_for(effect->info()), testing::IsEmpty()) << id;
  const Eigen::MatrixXd values = effect->regressor(signals, inner);
  return {values.col(column).begin(), values.col(column).end()};
}

auto near(std::vector<double> expected, double tolerance = 1e-12) {
  std::vector<testing::Matcher<double>> matchers;
  for (const double value : expected) matchers.push_back(DoubleNear(value, tolerance));
  return testing::ElementsAreArray(matchers);
}

TEST(Catalogue, EveryEffectIsDescribedOnceAndInFull) {
  std::set<std::string_view> ids;
  for (const Effect* effect : catalogue()) {
    const EffectInfo& info = effect->info();
    EXPECT_TRUE(ids.insert(info.id).second) << info.id;
    EXPECT_EQ(info.columns.size(), info.units.size()) << info.id;
    for (const std::string_view text :
         {info.formula, info.excited_by, info.confused_with, info.source}) {
      EXPECT_FALSE(text.empty()) << info.id;
    }
    for (const InnerParameter& p : info.parameters) {
      EXPECT_LT(p.minimum, p.maximum) << info.id;
      EXPECT_FALSE(p.unit.empty()) << info.id;
    }
    EXPECT_EQ(find_effect(info.id), effect);
  }
  EXPECT_GE(ids.size(), 43u);
}

TEST(Catalogue, NamesTheNearestOfAnUnknownEffect) {
  EXPECT_EQ(find_effect("magnetic_histeresis_z"), nullptr);
  EXPECT_THAT(unknown_effect("magnetic_histeresis_z"), HasSubstr("magnetic_hysteresis_z"));
}

TEST(Effects, TimeEffects) {
  EXPECT_THAT(regressor("bias"), ElementsAre(1, 1, 1, 1, 1));
  // The window 270..330 s holds the step at 285 s: three quarters of it lie after.
  EXPECT_THAT(regressor("bias_step", {285}), near({0, 0, 0.75, 1, 1}));
  EXPECT_THAT(regressor("drift_linear"),
              near({0, 100 / 3600.0, 200 / 3600.0, 300 / 3600.0, 400 / 3600.0}));
  const std::vector<double> decay = regressor("warm_up", {600});
  for (int i = 0; i < 5; ++i) {
    const double from = 100.0 * (i + 1) - 30, to = from + 60;
    const double mean = 600 / 60.0 * (std::exp(-from / 600) - std::exp(-to / 600));
    EXPECT_NEAR(decay[static_cast<std::size_t>(i)], mean, 1e-12);
  }
}

TEST(Effects, TemperatureEffects) {
  EXPECT_THAT(regressor("temperature_linear"), near({0, 10, 20, 15, 5}));
  EXPECT_THAT(regressor("temperature_quadratic"), near({0, 100, 400, 225, 25}));
  EXPECT_THAT(regressor("temperature_cubic"), near({0, 1000, 8000, 3375, 125}));
  EXPECT_THAT(regressor("temperature_rate"), near({0, 360, 360, -180, -360}));
  EXPECT_THAT(regressor("temperature_rate_cross"), near({0, 3600, 7200, -2700, -1800}));
  EXPECT_THAT(regressor("temperature_gradient"), near({0.1, 0.2, 0.3, 0.4, 0.5}));
  EXPECT_THAT(regressor("heater_power"), near({0, 12, 9, 0, 6}));
  EXPECT_THAT(regressor("ambient_temperature"), near({0, 1, 2, 3, 4}));
  // Play of half-width 4 on 0, 10, 20, 15, 5 from 0.
  EXPECT_THAT(regressor("temperature_hysteresis", {4}), near({0, 6, 16, 16, 9}));
  const double angle = 2 * std::numbers::pi * 31 / 8;
  EXPECT_NEAR(regressor("temperature_ripple", {8})[1], std::sin(angle), 1e-12);
  EXPECT_NEAR(regressor("temperature_ripple", {8}, five_rows(), 1)[1], std::cos(angle), 1e-12);
}

TEST(Effects, AccelerationIsTheSlopeOfTheRate) {
  // Neighbours 100 s away: central differences inside, one-sided at the ends; per hour.
  EXPECT_THAT(regressor("temperature_acceleration"),
              near({360 * 36, 360 * 18, -540 * 18, -720 * 18, -180 * 36}, 1e-8));
}

TEST(Effects, TheGradientsRateIsItsSlope) {
  EXPECT_THAT(regressor("temperature_gradient_rate"), near({3.6, 3.6, 3.6, 3.6, 3.6}, 1e-9));
}

TEST(Effects, MagneticEffects) {
  EXPECT_THAT(regressor("magnetic_linear_x"), near({0, 1, 2, 1, -1}));
  EXPECT_THAT(regressor("magnetic_linear_y"), near({0.5, 0, 0.5, 0, 0.5}));
  EXPECT_THAT(regressor("magnetic_quadratic_z"), near({0, 0, 1, 1, 4}));
  EXPECT_THAT(regressor("magnetic_cross_xy"), near({0, 0, 1, 0, -0.5}));
  EXPECT_THAT(regressor("magnetic_cross_yz"), near({0, 0, 0.5, 0, -1}));
  EXPECT_THAT(regressor("magnetic_cross_zx"), near({0, 0, 2, 1, 2}));
  EXPECT_THAT(regressor("magnetic_saturation_x", {2}),
              near({0, std::tanh(0.5), std::tanh(1.0), std::tanh(0.5), -std::tanh(0.5)}));
  // Play of half-width 0.5 on 0, 1, 2, 1, -1 from 0.
  EXPECT_THAT(regressor("magnetic_hysteresis_x", {0.5}), near({0, 0.5, 1.5, 1.5, -0.5}));
  EXPECT_THAT(regressor("magnetic_temperature_x"), near({0, 10, 40, 15, -5}));
  EXPECT_THAT(regressor("magnetic_temperature_rate_x"), near({0, 360, 720, -180, 360}));
}

TEST(Effects, SettlingIsAStepsExponentialAveragedOverTheWindows) {
  // Windows 70..130, 170..230, ...: the field steps at the end of the window before.
  const double tau = 50;
  const std::vector<double> found = regressor("magnetic_settling_x", {tau});
  const auto mean = [&](double from, double to) {
    return tau / (to - from) * (std::exp(-from / tau) - std::exp(-to / tau));
  };
  EXPECT_NEAR(found[0], 0.0, 1e-12);
  EXPECT_NEAR(found[1], mean(40, 100), 1e-12);                   // +1 at 130
  EXPECT_NEAR(found[2], mean(40, 100) + mean(140, 200), 1e-12);  // +1 at 230
  EXPECT_NEAR(found[3], -mean(40, 100) + mean(140, 200) + mean(240, 300), 1e-12);
}

TEST(Effects, CoilHeatingFollowsTheSquaredCurrentsWithALag) {
  Table table;
  table.set_column("time_s", {30, 90, 150});
  table.set_column("duration_s", {60, 60, 60});
  table.set_column("field_x_ut", {0, 300, 300});
  // Without gaps: a step of 9 at 60 s, 9 (1 - exp(-s/tau)) averaged over 0..60 and 60..120.
  const double tau = 600;
  const auto mean = [&](double from, double to) {
    return 9 * (1 - tau / (to - from) * (std::exp(-from / tau) - std::exp(-to / tau)));
  };
  EXPECT_THAT(regressor("coil_heating", {tau}, table), near({0, mean(0, 60), mean(60, 120)}));
  Table current;
  current.set_column("time_s", {30, 90, 150});
  current.set_column("duration_s", {60, 60, 60});
  current.set_column("coil_current_a", {0, 3, 3});
  EXPECT_THAT(regressor("coil_heating", {tau}, current), near({0, mean(0, 60), mean(60, 120)}));
  // Both pairs, whatever the field: what nulls the ambient field heats too. Cold at the start.
  table.set_column("current_horizontal_a", {1, 1, 1});
  table.set_column("current_vertical_a", {std::sqrt(8.0), std::sqrt(8.0), std::sqrt(8.0)});
  EXPECT_THAT(regressor("coil_heating", {tau}, table),
              near({mean(0, 60), mean(60, 120), mean(120, 180)}));
}

TEST(Effects, LaggedRateFollowsARampOfTheRateExactly) {
  // Samples without duration: the rate rises by 36 degC/h a second from 0 at 0 s; the lag of a ramp
  // s t is s (t - tau (1 - exp(-t/tau))). Irregular sampling must not matter.
  Table table;
  table.set_column("time_s", {0, 1, 5, 6.5, 20});
  table.set_column("temperature_rate_c_per_h", {0, 36, 180, 234, 720});
  const std::vector<double> found = regressor("temperature_rate_lagged", {40}, table);
  const double times[] = {0, 1, 5, 6.5, 20};
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(found[i], 36 * (times[i] - 40 * (1 - std::exp(-times[i] / 40))), 1e-9);
  }
}

TEST(Effects, EarthRateProjectionTurnsWithTheAzimuth) {
  EXPECT_THAT(regressor("earth_rate_projection"), near({1, 0, -1, 0, std::sqrt(0.75)}));
  EXPECT_THAT(regressor("earth_rate_projection", {}, five_rows(), 1), near({0, 1, 0, -1, 0.5}));
}

TEST(Effects, HistoryStartsAnewInEveryRunAndBridgesMissingRows) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Table table;
  table.set_column("time_s", {0, 1, 2, 3, 0, 1});
  table.set_column("field_z_ut", {300, nan, 0, 100, 0, 100});
  table.set_run({{"1", "2"}, {0, 0, 0, 0, 1, 1}});
  const std::vector<double> found = regressor("magnetic_hysteresis_z", {1}, table);
  EXPECT_EQ(found[0], 2.0);
  EXPECT_TRUE(std::isnan(found[1]));
  EXPECT_EQ(found[2], 1.0);
  EXPECT_EQ(found[3], 1.0);
  EXPECT_EQ(found[4], 0.0);
  EXPECT_EQ(found[5], 0.0);
}

TEST(Effects, ALoopOfPartsIsTheMeanOfItsPlays) {
  // One part of the widths 0 ... 1, as eight plays; two parts are its halves.
  std::vector<double> mean(5, 0.0);
  for (int i = 0; i < 8; ++i) {
    const auto play = regressor("magnetic_hysteresis_z", {(i + 0.5) / 8.0});
    for (std::size_t row = 0; row < mean.size(); ++row) mean[row] += play[row] / 8.0;
  }
  EXPECT_THAT(regressor("magnetic_loop_z(1)", {1.0}), near(mean));
  EXPECT_THAT(regressor("magnetic_loop_z(2)", {2.0}), near(mean));
  EXPECT_THAT(regressor("magnetic_saturating_loop_z(1)", {1.0, 1e6}), near(mean, 1e-9));
  const auto flat = regressor("magnetic_saturating_loop_z(1)", {1.0, 0.5});
  EXPECT_LT(*std::max_element(flat.begin(), flat.end()), 0.5);
  EXPECT_EQ(find_effect("temperature_loop(3)")->info().form_of, "temperature_hysteresis");
  for (const char* none : {"magnetic_loop_z", "magnetic_loop_z(0)", "magnetic_loop_z(9)",
                           "temperature_saturating_loop(2)", "(2)"}) {
    EXPECT_EQ(find_effect(none), nullptr) << none;
  }
}

TEST(Signals, RowOrderDoesNotMatter) {
  Table mixed;
  mixed.set_column("time_s", {3, 0, 1, 1, 2, 0});
  mixed.set_column("field_z_ut", {100, 0, 100, 300, 0, 300});
  mixed.set_run({{"a", "b"}, {1, 1, 1, 0, 1, 0}});
  const Signals signals(mixed, 21.0);
  ASSERT_EQ(signals.runs().size(), 2u);
  EXPECT_EQ(signals.runs()[1].begin, 4u);
  const auto order = {1, 2, 4, 0, 5, 3};  // run b first, as it appears first
  std::size_t i = 0;
  for (const int row : order) EXPECT_EQ(signals.table_row(i++), static_cast<std::size_t>(row));
  EXPECT_EQ(signals.signal("field_z_ut")[0], 0.0);
  EXPECT_EQ(signals.signal("field_z_ut")[3], 100.0);
  EXPECT_EQ(signals.block(3, 5).signal("field_z_ut")[1], 300.0);
}

TEST(Signals, TemperatureRateIsASlopeOverAMinute) {
  Table table;
  std::vector<double> time, temperature;
  for (int i = 0; i < 2000; ++i) {
    time.push_back(0.5 * i);
    // 36 degC/h with 1 mK of alternating noise: over one row it would be +-14 degC/h.
    temperature.push_back(30.0 + 0.01 * time.back() + (i % 2 == 0 ? 0.001 : -0.001));
  }
  table.set_column("time_s", time);
  table.set_column("temperature_c", temperature);
  const Signals signals(table, 21.0);
  const auto rate = signals.signal("temperature_rate_c_per_h");
  EXPECT_LT((rate.array() - 36.0).abs().maxCoeff(), 0.3);
}

TEST(Signals, NameWhatIsMissing) {
  Table table;
  table.set_column("time_s", {1, 2});
  table.set_column("field_x_ut", {std::nan(""), std::nan("")});
  const Signals signals(table, 21.0);
  EXPECT_THAT(signals.missing_for(find_effect("magnetic_linear_x")->info()),
              ElementsAre("field_x_ut"));
  EXPECT_THAT(signals.missing_for(find_effect("temperature_rate_cross")->info()),
              ElementsAre("temperature_c", "temperature_rate_c_per_h"));
  EXPECT_THAT(signals.missing_for(find_effect("warm_up")->info()), testing::IsEmpty());
}

}  // namespace
}  // namespace fogbench::model
