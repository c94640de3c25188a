#include "model/diagnose/formula_search.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "model/diagnose/formula_parts.hpp"
#include "model/effects/expression.hpp"
#include "tests/model/models.hpp"

namespace fogbench::model {
namespace {

/// A temperature that rises by 40 degC and a field that turns several times meanwhile.
Table heated_sweep() {
  std::vector<double> time, temperature, field;
  for (int i = 0; i < 160; ++i) {
    time.push_back(120.0 * (i + 1));
    temperature.push_back(20.0 + 0.25 * i);
    field.push_back(150.0 * std::sin(0.23 * i));
  }
  Table out;
  out.set_column("time_s", time);
  out.set_column("duration_s", std::vector<double>(160, 120.0));
  out.set_column("temperature_c", temperature);
  out.set_column("field_z_ut", field);
  return out;
}

/// The formula for a rate of a bias, `hidden` and noise of 0.005 deg/h.
template <class Hidden>
std::optional<Formula> formula_of(Hidden hidden) {
  Table table = heated_sweep();
  std::vector<double> rate;
  std::uint32_t state = 4711;
  for (std::size_t i = 0; i < table.rows(); ++i) {
    state = state * 1664525u + 1013904223u;
    const double scatter = static_cast<double>(state >> 8) / (1u << 24) - 0.5;
    rate.push_back(0.5 + 0.017 * scatter +
                   hidden(table.column("temperature_c")[i], table.column("field_z_ut")[i]));
  }
  table.set_column("rate_deg_per_h", rate);
  const config::ModelFile model = model_of_effects({"bias"});
  const auto working = WorkingTable::make(table, model, nullptr);
  EXPECT_TRUE(working);
  const Signals signals(working->fine(), 21.0);
  const std::vector<config::ModelTerm> none;
  const Eigen::VectorXd y = Eigen::Map<const Eigen::VectorXd>(rate.data(), std::ssize(rate));
  return search_formula({*working, signals, model, none}, Eigen::MatrixXd::Ones(y.size(), 1), y);
}

TEST(FormulaSearch, FindsAKinkToItsPlace) {
  const auto found = formula_of([](double t, double) { return 0.03 * std::max(t - 43.0, 0.0); });
  ASSERT_TRUE(found);
  EXPECT_EQ(found->expression.rfind("max(temperature_c - 4", 0), 0U) << found->expression;
  EXPECT_LT(found->heldout_rms, 0.006);
  EXPECT_GT(found->heldout_rms_without, 0.1);
}

TEST(FormulaSearch, FindsAProduct) {
  const auto found = formula_of([](double t, double h) { return 1e-5 * std::abs(h) * t; });
  ASSERT_TRUE(found);
  EXPECT_EQ(found->expression, "abs(field_z_ut) * temperature_c");
  EXPECT_LT(found->heldout_rms, 0.006);
}

TEST(FormulaSearch, AddsUpWhatOnePartDoesNotExplain) {
  const auto found = formula_of([](double t, double h) {
    return 0.02 * std::sin(2.0 * M_PI * t / 9.0) + (h > 60.0 ? 0.05 : 0.0);
  });
  ASSERT_TRUE(found);
  EXPECT_LT(found->heldout_rms, 0.0075) << found->expression;
}

TEST(FormulaSearch, NoiseHasNoFormula) {
  EXPECT_FALSE(formula_of([](double, double) { return 0.0; }));
}

TEST(FormulaParts, EveryPartIsAnExpressionThatCanBePasted) {
  const Table table = heated_sweep();
  const Signals signals(table, 21.0);
  const auto parts = formula_parts(signals);
  EXPECT_GT(parts.size(), 300U);
  for (const FormulaPart& part : parts) {
    const auto expression = Expression::parse("term", text_of(part), {}, signals);
    EXPECT_TRUE(expression) << text_of(part);
  }
}

}  // namespace
}  // namespace fogbench::model
