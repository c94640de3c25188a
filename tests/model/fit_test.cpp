#include "model/fit/fit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "model/fit/predict.hpp"
#include "tests/model/models.hpp"

namespace fogbench::model {
namespace {

using config::ModelFile;
using config::ModelTerm;
using testing::HasSubstr;

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

ModelTerm formula(std::string name, std::string expression,
                  std::map<std::string, double> parameters = {}) {
  ModelTerm result = term(std::move(name));
  result.expression = std::move(expression);
  result.parameters = std::move(parameters);
  return result;
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

std::string error_of(const Table& table, const ModelFile& model, const FitOptions& options = {}) {
  const auto result = fit(table, model, options);
  if (result) return "no error";
  EXPECT_EQ(result.error().code, ErrorCode::kBadInput);
  EXPECT_EQ(result.error().message.find('\n'), std::string::npos);
  return result.error().message;
}

/// A sweep of one axis up, down and back, every 200 s a window of 180 s.
Table field_sweep(int loops) {
  std::vector<double> time, duration, field;
  for (int i = 0; i < 24 * loops; ++i) {
    time.push_back(100.0 + 200.0 * i);
    duration.push_back(180.0);
    const int step = i % 24;
    const int level = step <= 6 ? step : step <= 18 ? 12 - step : step - 24;
    field.push_back(50.0 * level);
  }
  Table table;
  table.set_column("time_s", time);
  table.set_column("duration_s", duration);
  table.set_column("field_z_ut", field);
  return table;
}

/// The observable from a model with all its coefficients, plus white noise.
void simulate(Table& table, const ModelFile& truth, double sigma, unsigned seed) {
  const auto clean = predict(table, truth);
  ASSERT_TRUE(clean) << clean.error().message;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, sigma);
  std::vector<double> rate;
  for (const double value : *clean) rate.push_back(value + noise(random));
  table.set_column("rate_deg_per_h", rate);
}

ModelFile hysteresis_truth() {
  ModelTerm bias = term("bias"), linear = term("magnetic_linear_z");
  ModelTerm play = term("magnetic_hysteresis_z");
  bias.coefficient = 0.7;
  linear.coefficient = -0.25;
  play.coefficient = 0.12;
  play.parameters = {{"width", 0.6}};
  return model_of({bias, linear, play});
}

TEST(Fit, FindsAnInnerParameterThatNobodyGave) {
  Table table = field_sweep(3);
  simulate(table, hysteresis_truth(), 0.002, 7);
  const auto found =
      fit(table, model_of({term("bias"), term("magnetic_linear_z"), term("magnetic_hysteresis_z")}),
          {.noise = FitOptions::Noise::kIndependent});
  ASSERT_TRUE(found) << found.error().message;
  const double truth[] = {0.7, -0.25, 0.12, 0.6};
  for (std::size_t i = 0; i < 4; ++i) {
    const Estimate& e = found->estimates[i];
    EXPECT_LT(std::abs(e.value - truth[i]), 4.0 * e.standard_error) << e.name;
    EXPECT_GT(e.standard_error, 0.0) << e.name;
  }
  EXPECT_EQ(found->estimates[3].name, "magnetic_hysteresis_z.width");
  EXPECT_NEAR(found->residual_standard_deviation, 0.002, 0.0005);
  // What was fitted can be read as a model again, and predicts what was fitted.
  const auto again = predict(table, found->fitted);
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_LT((*again - found->predicted).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(found->fitted.fit->parameter_names.size(), 4u);
}

TEST(Fit, ColouredNoiseIsEstimatedWithTheCoefficients) {
  Table table = field_sweep(6);
  simulate(table, hysteresis_truth(), 0.005, 11);
  const auto found =
      fit(table, model_of({term("bias"), term("magnetic_linear_z"), term("magnetic_hysteresis_z")}),
          {});
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_TRUE(found->coloured);
  const double truth[] = {0.7, -0.25, 0.12, 0.6};
  for (std::size_t i = 1; i < 4; ++i) {
    const Estimate& e = found->estimates[i];
    EXPECT_LT(std::abs(e.value - truth[i]), 4.0 * e.standard_error) << e.name;
  }
  // 5 mdeg/h in 180 s is N = 0.00112 deg/sqrt(h).
  EXPECT_NEAR(found->noise.noise.angle_random_walk_deg_per_sqrt_h, 0.00112, 0.0003);
  EXPECT_EQ(found->whitened.size(), found->residual.size());
}

/// Loops of noise: no term of any kind is there but the bias.
Table noise_loops(unsigned seed) {
  Table table = field_sweep(3);
  simulate(table, model_of({term("bias", 0.2)}), 0.003, seed);
  return table;
}

// Where nothing identifies the width it runs to its bound, and there the joint solution would move
// it much further: its coefficients are no solution at the width that is kept.
TEST(Fit, AnInnerParameterAtItsBoundLeavesNoMoreThanTheTermsWithoutIt) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const Table table = noise_loops(seed);
    const auto before = fit(table, model_of({term("bias"), term("magnetic_linear_z")}), {});
    const auto after =
        fit(table,
            model_of({term("bias"), term("magnetic_linear_z"), term("magnetic_hysteresis_z")}), {});
    ASSERT_TRUE(before && after);
    EXPECT_TRUE(after->coloured);
    EXPECT_LT(after->rms, 1.1 * before->rms) << seed;
  }
}

TEST(Fit, HeldCoefficientsStayAndTheOthersAdapt) {
  Table table;
  table.set_column("field_x_ut", {0, 100, 200, 300});
  table.set_column("rate_deg_per_h", {1.0, 3.0, 5.0, 7.0});
  ModelTerm linear = term("magnetic_linear_x");
  linear.coefficient = 1.0;
  linear.fixed = true;
  const auto found = fit(table, model_of({term("bias"), linear}), {});
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->estimates[1].held);
  EXPECT_EQ(found->estimates[1].value, 1.0);
  EXPECT_NEAR(found->estimates[0].value, 2.5, 1e-12);  // mean of 1, 2, 3, 4
}

TEST(Fit, AsIsHoldsEveryGivenCoefficient) {
  ModelTerm bias = term("bias"), linear = term("temperature_linear");
  ModelTerm quadratic = term("temperature_quadratic");
  bias.coefficient = 1.197;
  linear.coefficient = -0.108;
  quadratic.coefficient = 0.004;
  const ModelFile published = model_of({bias, linear, quadratic});
  const auto held = fit(published_thermal(), published, {.as_is = true});
  ASSERT_TRUE(held) << held.error().message;
  // 1.197 - 0.108 x 34 + 0.004 x 34^2 = 2.149 where the table has 1.564.
  EXPECT_NEAR(held->predicted[5], 2.149, 1e-12);
  EXPECT_NEAR(held->residual[5], -0.585, 1e-12);
  // The noise is what the free fit of the same terms leaves: RMS 0.05518 of 6 rows, 3 free.
  EXPECT_NEAR(held->standard_deviation[5], 0.05518 * std::sqrt(2.0), 1e-5);
  EXPECT_THAT(
      error_of(published_thermal(), model_of({bias, term("temperature_linear")}), {.as_is = true}),
      HasSubstr("term temperature_linear: has no coefficient"));
}

TEST(Fit, DependentTermsAreNamedAndLeftOut) {
  Table table;
  table.set_column("field_x_ut", {100, 100, 100, 100});
  table.set_column("rate_deg_per_h", {1.0, 1.1, 0.9, 1.0});
  const auto found = fit(table, model_of({term("bias"), term("magnetic_linear_x")}), {});
  ASSERT_TRUE(found);
  ASSERT_EQ(found->warnings.size(), 1u);
  EXPECT_THAT(found->warnings[0], HasSubstr("cannot separate magnetic_linear_x from bias"));
  EXPECT_NEAR(found->estimates[0].value, 1.0, 1e-12);
  EXPECT_TRUE(std::isnan(found->estimates[1].value));
  EXPECT_TRUE(std::isnan(found->estimates[1].standard_error));
  EXPECT_EQ(found->degrees_of_freedom, 3.0);
  EXPECT_EQ(found->fitted.terms.size(), 1u);
  ASSERT_TRUE(predict(table, found->fitted));
}

TEST(Fit, TermThatIsZeroEverywhereIsNamed) {
  Table table;
  table.set_column("field_x_ut", {0, 0, 0});
  table.set_column("rate_deg_per_h", {1.0, 1.1, 0.9});
  const auto found = fit(table, model_of({term("bias"), term("magnetic_linear_x")}), {});
  ASSERT_TRUE(found);
  EXPECT_THAT(found->warnings.at(0), HasSubstr("zero in every row"));
}

TEST(Fit, AsManyUnknownsAsRowsHasNoUncertainty) {
  Table table;
  table.set_column("x", {1, 2});
  table.set_column("rate_deg_per_h", {1, 3});
  const auto found = fit(table, model_of({term("bias"), formula("slope", "x")}), {});
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->estimates[1].value, 2.0, 1e-12);
  EXPECT_TRUE(std::isnan(found->estimates[1].standard_error));
  EXPECT_THAT(found->warnings.at(0), HasSubstr("uncertainty is unknown"));
}

TEST(Fit, OneRowGivesABias) {
  Table table;
  table.set_column("rate_deg_per_h", {1.5});
  const auto found = fit(table, model_of({term("bias")}), {});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->estimates[0].value, 1.5);
}

TEST(Fit, MissingRowsAreLeftOutAndTheirOrderDoesNotMatter) {
  Table table;
  table.set_column("time_s", {3, 1, 2, 4});
  table.set_column("field_x_ut", {300, 100, kMissing, 400});
  table.set_column("rate_deg_per_h", {3, 1, 7, 4});
  const auto found = fit(table, model_of({term("magnetic_linear_x")}), {});
  ASSERT_TRUE(found);
  EXPECT_THAT(found->rows, testing::ElementsAre(1, 0, 3));
  EXPECT_NEAR(found->estimates[0].value, 1.0, 1e-12);
  const auto everywhere = predict(table, found->fitted);
  ASSERT_TRUE(everywhere);
  EXPECT_NEAR((*everywhere)[0], 3.0, 1e-12);
  EXPECT_TRUE(std::isnan((*everywhere)[2]));
}

TEST(Fit, ErrorsNameWhatIsWrong) {
  Table table;
  table.set_column("rate_deg_per_h", {1, 2, 3});
  table.set_column("x", {-1, 0, 1});
  table.set_column("empty", {kMissing, kMissing, kMissing});
  EXPECT_THAT(error_of(table, model_of({term("bais")})), HasSubstr("unknown effect 'bais'"));
  EXPECT_THAT(error_of(table, model_of({term("magnetic_linear_x")})),
              HasSubstr("term magnetic_linear_x: column field_x_ut"));
  EXPECT_THAT(error_of(table, model_of({})), HasSubstr("no terms"));
  EXPECT_THAT(error_of(table, model_of({term("bias")}, "omega")), HasSubstr("column omega"));
  EXPECT_THAT(error_of(table, model_of({term("bias")}, "empty")),
              HasSubstr("column empty: found no number"));
  EXPECT_THAT(error_of(table, model_of({term("bias"), formula("a", "x"), formula("b", "x^2"),
                                        formula("c", "x^3")})),
              HasSubstr("found 3 usable rows, expected at least 4"));
  EXPECT_THAT(error_of(table, model_of({term("bias")}), {.weight_by = "x"}),
              HasSubstr("column x: found -1 in row 1"));
  EXPECT_THAT(error_of(table, model_of({term("bias")}), {.weight_by = "sigma"}),
              HasSubstr("column sigma"));
  EXPECT_THAT(error_of(table, model_of({term("bias")}), {.noise = FitOptions::Noise::kColoured}),
              HasSubstr("column time_s"));
  EXPECT_THAT(error_of(table, model_of({formula("root", "sqrt(x)")})),
              HasSubstr("term root: is not a finite number in row 1"));
  ModelTerm fixed = term("bias");
  fixed.fixed = true;
  EXPECT_THAT(error_of(table, model_of({fixed})), HasSubstr("bias has no coefficient"));
  ModelTerm wrong = term("bias");
  wrong.parameters = {{"tau", 1.0}};
  EXPECT_THAT(error_of(table, model_of({wrong})), HasSubstr("found the parameter 'tau'"));
}

TEST(Expression, ErrorsNameTheTerm) {
  Table table;
  table.set_column("rate_deg_per_h", {1, 2, 3});
  table.set_column("x", {1, 2, 3});
  EXPECT_THAT(error_of(table, model_of({formula("mine", "2*(x")})),
              HasSubstr("term mine: found '2*(x', expected a formula"));
  EXPECT_THAT(error_of(table, model_of({formula("mine", "2*z")})),
              HasSubstr("term mine: found the name 'z'"));
  EXPECT_THAT(error_of(table, model_of({formula("mine", "x, x")})),
              HasSubstr("term mine: found 2"));
  EXPECT_THAT(error_of(table, model_of({formula("mine", "")})), HasSubstr("term mine"));
  EXPECT_THAT(error_of(table, model_of({formula("mine", "2*x", {{"x", 1.0}})})),
              HasSubstr("also a column"));
  EXPECT_THAT(error_of(table, model_of({formula("mine", "2*x", {{"b", 1.0}})})),
              HasSubstr("does not use"));
  // muParser would write 3 into the column.
  EXPECT_THAT(error_of(table, model_of({formula("mine", "x=3")})),
              HasSubstr("found an assignment in 'x=3'"));
  EXPECT_THAT(error_of(table, model_of({formula("mine", std::string(5000, '('))})),
              testing::AllOf(HasSubstr("(..."), testing::SizeIs(testing::Le(400u))));
  EXPECT_THAT(error_of(table, model_of({formula("bias_step", "x")})),
              HasSubstr("term bias_step: is an effect of the catalogue"));
  table.set_column("temperature_c", {kMissing, kMissing, kMissing});
  EXPECT_THAT(error_of(table, model_of({term("temperature_linear")})),
              HasSubstr("column temperature_c: found no number in any row"));
}

TEST(Expression, KnowsTheOperatorsThatAreDocumented) {
  Table table;
  table.set_column("x", {2.0});
  ModelFile model = model_of(
      {formula("f",
               "-x^2 + 2^3^0 + exp(0) + ln(e) + sin(pi/2) + cos(0) + "
               "atan(0) + sqrt(4) + abs(-1) + (x > 1 ? 10 : 20) + (x == 2) + (x >= 3) + (x <= 1) + "
               "(x != 2)")});
  model.terms[0].coefficient = 1.0;
  const auto value = predict(table, model);
  ASSERT_TRUE(value) << value.error().message;
  EXPECT_NEAR((*value)[0], -4 + 2 + 1 + 1 + 1 + 1 + 0 + 2 + 1 + 10 + 1, 1e-12);
}

TEST(Expression, ParameterOfOneTermIsSharedByTheOthers) {
  Table table;
  std::vector<double> x, y;
  for (int i = 0; i < 40; ++i) {
    x.push_back(0.1 * i);
    y.push_back(2.0 * std::cos(1.7 * x.back()) - 3.0 * std::sin(1.7 * x.back()));
  }
  table.set_column("x", x);
  table.set_column("rate_deg_per_h", y);
  const auto found =
      fit(table, model_of({formula("c", "cos(w*x)", {{"w", 1.5}}), formula("s", "sin(w*x)")}), {});
  ASSERT_TRUE(found) << found.error().message;
  ASSERT_EQ(found->estimates.size(), 3u);
  EXPECT_NEAR(estimate(*found, "c.w").value, 1.7, 1e-9);
  EXPECT_NEAR(estimate(*found, "s").value, -3.0, 1e-9);
}

TEST(Fit, InnerParameterAtTheEdgeOfItsRangeIsSaid) {
  Table table = field_sweep(1);
  std::vector<double> rate;
  for (std::size_t i = 0; i < table.rows(); ++i) rate.push_back(0.01 * static_cast<double>(i));
  table.set_column("rate_deg_per_h", rate);
  const auto found = fit(table, model_of({term("bias"), term("warm_up")}),
                         {.noise = FitOptions::Noise::kIndependent});
  ASSERT_TRUE(found);
  bool said = false;
  for (const std::string& w : found->warnings) {
    said = said || w.find("edge of its range") != std::string::npos;
  }
  EXPECT_TRUE(said);
}

// 21 to 55 degC; the field is what its sensor's noise makes of none.
TEST(Fit, LeavesOutWhatTheDataNeverExciteAndSaysSo) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  Table table;
  std::vector<double> rate, temperature, field;
  for (int i = 0; i < 200; ++i) {
    temperature.push_back(21.0 + 0.17 * i);
    field.push_back(0.05 * normal(random));
    rate.push_back(0.5 - 0.1 * 0.17 * i + 0.02 * normal(random));
  }
  table.set_column("rate_deg_per_h", rate);
  table.set_column("temperature_c", temperature);
  table.set_column("field_x_ut", field);
  const ModelFile asked =
      model_of({term("bias"), term("magnetic_linear_x"), term("temperature_linear")});
  const auto fitted = fit(table, asked, {});
  ASSERT_TRUE(fitted) << fitted.error().message;
  ASSERT_EQ(fitted->estimates.size(), 3U);
  const Estimate& unexcited = fitted->estimates[1];
  EXPECT_EQ(unexcited.name, "magnetic_linear_x");
  EXPECT_EQ(unexcited.unexcited, "field_x_ut stays at one value");
  EXPECT_TRUE(std::isnan(unexcited.value));
  EXPECT_NEAR(fitted->estimates[2].value, -0.1, 4.0 * fitted->estimates[2].standard_error);
  EXPECT_TRUE(fitted->estimates[2].unexcited.empty());
  ASSERT_EQ(fitted->covariance.rows(), 3);
  EXPECT_TRUE(std::isnan(fitted->covariance(1, 1)));
  EXPECT_NEAR(std::sqrt(fitted->covariance(2, 2)), fitted->estimates[2].standard_error, 1e-15);
  EXPECT_THAT(fitted->warnings,
              testing::Contains(HasSubstr("magnetic_linear_x is left out: these data do not")));
  ASSERT_EQ(fitted->fitted.terms.size(), 2U);
  EXPECT_EQ(fitted->fitted.terms[1].effect, "temperature_linear");
}

// The same small field, but so strong an effect that it shows all the same.
TEST(Fit, KeepsWhatShowsHoweverLittleItWasExcited) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  Table table;
  std::vector<double> rate, field;
  for (int i = 0; i < 200; ++i) {
    field.push_back(0.05 * normal(random));
    rate.push_back(0.5 + 2.0 * field.back() + 0.02 * normal(random));
  }
  table.set_column("rate_deg_per_h", rate);
  table.set_column("field_x_ut", field);
  const auto fitted = fit(table, model_of({term("bias"), term("magnetic_linear_x")}), {});
  ASSERT_TRUE(fitted) << fitted.error().message;
  EXPECT_NEAR(fitted->estimates[1].value, 200.0, 4.0 * fitted->estimates[1].standard_error);
  EXPECT_TRUE(fitted->estimates[1].unexcited.empty());
}

}  // namespace
}  // namespace fogbench::model
