#include "model/fit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace fogbench::model {
namespace {

using config::ModelFile;
using config::ModelTerm;
using testing::HasSubstr;

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

ModelTerm term(std::string effect) {
  ModelTerm result;
  result.effect = std::move(effect);
  return result;
}

ModelTerm formula(std::string name, std::string expression,
                  std::map<std::string, double> parameters = {}) {
  ModelTerm result = term(std::move(name));
  result.expression = std::move(expression);
  result.parameters = std::move(parameters);
  return result;
}

ModelFile model_of(std::vector<ModelTerm> terms, std::string observable = "rate_deg_per_h") {
  ModelFile model;
  model.observable = std::move(observable);
  model.terms = std::move(terms);
  return model;
}

/// The published thermal table: set points, deviations from the unheated baseline, sigmas.
Table published_thermal() {
  Table table;
  table.set_column("temperature_c", {31, 35, 40, 45, 50, 55});
  table.set_column("rate_deg_per_h", {0.489, 0.346, 0.498, 0.540, 0.919, 1.564});
  table.set_column("sigma_deg_per_h", {0.081, 0.051, 0.051, 0.043, 0.043, 0.019});
  return table;
}

const Estimate& estimate(const FitResult& result, const std::string& name) {
  for (const Estimate& e : result.estimates) {
    if (e.name == name) return e;
  }
  static const Estimate none{"none", "", kMissing, kMissing, kMissing, false};
  ADD_FAILURE() << "no estimate " << name;
  return none;
}

TEST(Fit, PublishedThermalTableGivesItsLeastSquaresQuadratic) {
  const Table table = published_thermal();
  const ModelFile quadratic =
      model_of({term("bias"), term("temperature_linear"), term("temperature_quadratic")});
  const auto plain = fit(table, quadratic, {});
  ASSERT_TRUE(plain) << plain.error().message;
  EXPECT_NEAR(plain->estimates[0].value, 1.30551511, 5e-9);
  EXPECT_NEAR(plain->estimates[1].value, -0.11725875, 5e-9);
  EXPECT_NEAR(plain->estimates[2].value, 0.00364289, 5e-9);
  EXPECT_NEAR(plain->rms, 0.05518, 5e-6);
  const auto weighted = fit(table, quadratic, {.weight_by = "sigma_deg_per_h"});
  ASSERT_TRUE(weighted) << weighted.error().message;
  EXPECT_NEAR(weighted->estimates[0].value, 1.42433146, 5e-9);
  EXPECT_NEAR(weighted->estimates[1].value, -0.12972413, 5e-9);
  EXPECT_NEAR(weighted->estimates[2].value, 0.00393091, 5e-9);
}

TEST(Fit, StandardErrorsAreThoseOfAStraightLine) {
  Table table;
  table.set_column("x", {1, 2, 3, 4});
  table.set_column("y", {1.1, 1.9, 3.2, 3.8});
  const auto line = fit(table, model_of({term("bias"), formula("slope", "x")}, "y"), {});
  ASSERT_TRUE(line) << line.error().message;
  // By hand: slope 0.94, intercept 0.15, RSS 0.082, s^2 = 0.041, se(slope) = sqrt(0.041/5).
  EXPECT_NEAR(estimate(*line, "slope").value, 0.94, 1e-12);
  EXPECT_NEAR(estimate(*line, "bias").value, 0.15, 1e-12);
  EXPECT_NEAR(line->residual_sum_of_squares, 0.082, 1e-12);
  EXPECT_NEAR(estimate(*line, "slope").standard_error, std::sqrt(0.041 / 5.0), 1e-12);
  EXPECT_NEAR(estimate(*line, "bias").standard_error, std::sqrt(0.041 * 1.5), 1e-12);
  // Student's t with 2 degrees of freedom at 95.45 %.
  EXPECT_NEAR(estimate(*line, "slope").coverage_factor, 4.5265, 1e-3);
}

}  // namespace
}  // namespace fogbench::model
