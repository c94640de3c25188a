#include "model/effects/sensitivity.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "model/diagnose/diagnose.hpp"
#include "model/diagnose/verdict_text.hpp"
#include "model/effects/catalogue.hpp"
#include "model/fit/fit.hpp"
#include "model/fit/predict.hpp"
#include "tests/model/models.hpp"

namespace fogbench::model {
namespace {

constexpr std::size_t kRowsOfSupply = 90;

/// Windows of three minutes, a field that goes up and down, a supply that wanders, and a rate of
/// the field alone.
Table wandering_supply(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> time, field, supply, rate;
  double volts = 5.0;
  for (std::size_t i = 0; i < kRowsOfSupply; ++i) {
    volts += 0.02 * normal(random);
    time.push_back(180.0 * static_cast<double>(i + 1));
    field.push_back(200.0 * std::sin(0.35 * static_cast<double>(i)));
    supply.push_back(volts);
    rate.push_back(0.7 - 0.0025 * field.back() + 0.01 * normal(random));
  }
  Table out;
  out.set_column("time_s", time);
  out.set_column("duration_s", std::vector<double>(kRowsOfSupply, 180.0));
  out.set_column("field_z_ut", field);
  out.set_column("supply_v", supply);
  out.set_column("rate_deg_per_h", rate);
  return out;
}

template <class Of>
Table plus(Table table, Of of) {
  const auto given = table.column("rate_deg_per_h");
  std::vector<double> rate(given.begin(), given.end());
  for (std::size_t i = 0; i < rate.size(); ++i) rate[i] += of(i);
  table.set_column("rate_deg_per_h", rate);
  return table;
}

Result<Diagnosis> diagnosis_of(const Table& table) {
  return diagnose(table, model_of_effects({"bias", "magnetic_linear_z"}), {});
}

TEST(Sensitivity, IsAnEffectOfAnyColumn) {
  const Effect* effect = find_effect("sensitivity_field_z(supply_v)");
  ASSERT_NE(effect, nullptr);
  EXPECT_EQ(effect, find_effect("sensitivity_field_z(supply_v)"));
  EXPECT_EQ(effect->info().id, "sensitivity_field_z(supply_v)");
  EXPECT_EQ(effect->info().formula, "supply_v h_z");
  EXPECT_EQ(effect->info().units.front(), "deg/h per 100 uT/V");
  const Table table = wandering_supply(1);
  const Signals signals(table, 21.0);
  const Eigen::MatrixXd values = effect->regressor(signals, {});
  for (std::size_t i = 0; i < kRowsOfSupply; ++i) {
    EXPECT_DOUBLE_EQ(values(static_cast<Eigen::Index>(i), 0),
                     table.column("supply_v")[i] * table.column("field_z_ut")[i] / 100.0);
  }
  for (const char* wrong : {"sensitivity", "sensitivity()", "sensitivity_cubed(supply_v)",
                            "sensitivity(supply_v", "(supply_v)"}) {
    EXPECT_EQ(find_effect(wrong), nullptr) << wrong;
  }
}

TEST(Sensitivity, AnAbsentColumnIsNamed) {
  const auto fitted =
      fit(wandering_supply(1), model_of_effects({"bias", "sensitivity(pressure_hpa)"}), {});
  ASSERT_FALSE(fitted);
  EXPECT_NE(fitted.error().message.find("column pressure_hpa"), std::string::npos);
}

TEST(Sensitivity, AModelWithOneIsFittedAndPredicts) {
  const Table table = wandering_supply(2);
  const auto moved = plus(table, [&](std::size_t i) { return 0.8 * table.column("supply_v")[i]; });
  const auto fitted =
      fit(moved, model_of_effects({"bias", "magnetic_linear_z", "sensitivity(supply_v)"}), {});
  ASSERT_TRUE(fitted) << fitted.error().message;
  EXPECT_NEAR(fitted->estimates.back().value, 0.8, 4.0 * fitted->estimates.back().standard_error);
  EXPECT_EQ(fitted->estimates.back().unit, "deg/h/V");
  const auto text = config::to_json_text(fitted->fitted);
  EXPECT_NE(text.find("sensitivity(supply_v)"), std::string::npos);
  EXPECT_TRUE(predict(moved, fitted->fitted));
}

TEST(Sensitivity, ACauseThatSomebodyRecordedIsNamed) {
  const Table table = wandering_supply(3);
  const auto found =
      diagnosis_of(plus(table, [&](std::size_t i) { return 0.8 * table.column("supply_v")[i]; }));
  ASSERT_TRUE(found) << found.error().message;
  ASSERT_EQ(found->missing.size(), 1U) << verdict_in_words(*found, "").verdict;
  EXPECT_EQ(found->missing[0].found.effect, "sensitivity(supply_v)");
  EXPECT_EQ(name_of(found->verdict), "missing_effect") << verdict_in_words(*found, "").verdict;
}

TEST(Sensitivity, AProductWithTheFieldIsNamed) {
  const Table table = wandering_supply(4);
  const auto found = diagnosis_of(plus(table, [&](std::size_t i) {
    return 0.5 * (table.column("supply_v")[i] - 5.0) * table.column("field_z_ut")[i] / 100.0;
  }));
  ASSERT_TRUE(found) << found.error().message;
  ASSERT_FALSE(found->missing.empty()) << verdict_in_words(*found, "").verdict;
  EXPECT_EQ(found->missing[0].found.effect, "sensitivity_field_z(supply_v)");
}

TEST(Sensitivity, AConstantColumnIsNotTestable) {
  Table table = wandering_supply(5);
  table.set_column("supply_v", std::vector<double>(kRowsOfSupply, 5.0));
  const auto found = diagnosis_of(table);
  ASSERT_TRUE(found);
  const auto& not_testable = found->not_testable;
  EXPECT_TRUE(std::any_of(not_testable.begin(), not_testable.end(), [](const NotTestable& n) {
    return n.effect == "sensitivity(supply_v)" && n.because == "supply_v stays at one value";
  }));
}

// Four columns that have nothing to do with the rate: 60 tables at 5 % give 3 +- 1.7 alarms.
TEST(Sensitivity, ColumnsOfChanceRaiseNoAlarms) {
  constexpr int kTables = 60;
  int alarms = 0;
  for (int k = 0; k < kTables; ++k) {
    Table table = wandering_supply(static_cast<std::uint64_t>(1000 + k));
    for (int c = 0; c < 3; ++c) {
      const Table other = wandering_supply(static_cast<std::uint64_t>(5000 + 10 * k + c));
      const auto column = other.column("supply_v");
      table.set_column(fmt::format("pressure_{}", c), {column.begin(), column.end()});
    }
    const auto found = diagnosis_of(table);
    ASSERT_TRUE(found);
    alarms += name_of(found->verdict) == "adequate" ? 0 : 1;
  }
  std::printf("  alarms: %d of %d\n", alarms, kTables);
  EXPECT_LE(alarms, 8);
}

}  // namespace
}  // namespace fogbench::model
