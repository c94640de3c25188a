#include "config/model_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "config/limits.hpp"
#include "tests/config/changed_file.hpp"

namespace fogbench::config {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string terms_mistake(const std::string& terms) {
  ChangedFile file;
  return message_of(load_model(file.write(R"({"name": "m", "terms": )" + terms + "}")));
}

/// What a fit returns, with numbers that a decimal text does not hold in a few digits.
ModelFile fitted_model() {
  ModelFile model;
  model.name = "fitted";
  ModelTerm bias;
  bias.effect = "bias";
  bias.coefficient = 1.0 / 3;
  bias.standard_errors = {{"bias", 1e-3 / 7}};
  ModelTerm play;
  play.effect = "magnetic_hysteresis_z";
  play.coefficient = -0.12;
  play.fixed = true;
  play.parameters = {{"width", 0.61}};
  ModelTerm turn;
  turn.effect = "earth_rate_projection";
  turn.coefficients = {{"cos", 8.47}, {"sin", -0.1}};
  ModelTerm own;
  own.effect = "my_term";
  own.expression = "abs(field_z_ut)/100 * temperature_c";
  own.unit = "deg/h";
  model.terms = {bias, play, turn, own};
  FitRecord fit;
  fit.data = "run 7";
  fit.data_sha256 = "00ff";
  fit.fitted_at = "2026-01-01T00:00:00Z";
  fit.software_version = "0.1.0";
  fit.parameter_names = {"bias", "my_term"};
  fit.covariance = {{1e-7, -2e-9}, {-2e-9, 3e-11}};
  fit.noise.angle_random_walk_deg_per_sqrt_h = 0.00123;
  fit.rms_deg_per_h = 0.031;
  fit.degrees_of_freedom = 70.5;
  fit.rows = 75;
  model.fit = fit;
  return model;
}

TEST(ModelFile, FittedModelReadsBackAsItWas) {
  const ModelFile model = fitted_model();
  ChangedFile file;
  const auto back = load_model(file.write(to_json_text(model)));
  ASSERT_TRUE(back) << back.error().message;
  ASSERT_EQ(back->terms.size(), 4U);
  EXPECT_EQ(back->terms[0].coefficient, 1.0 / 3);
  EXPECT_EQ(back->terms[0].standard_errors, model.terms[0].standard_errors);
  EXPECT_TRUE(back->terms[1].fixed);
  EXPECT_EQ(back->terms[1].parameters, model.terms[1].parameters);
  EXPECT_EQ(back->terms[2].coefficients, model.terms[2].coefficients);
  EXPECT_FALSE(back->terms[2].coefficient.has_value());
  EXPECT_EQ(back->terms[3].expression, model.terms[3].expression);
  ASSERT_TRUE(back->fit.has_value());
  EXPECT_EQ(back->fit->covariance, model.fit->covariance);
  EXPECT_EQ(back->fit->noise.angle_random_walk_deg_per_sqrt_h, 0.00123);
  EXPECT_EQ(back->fit->rows, 75U);
  EXPECT_EQ(to_json_text(*back), to_json_text(model));
}

TEST(ModelFile, KeysStandInTheOrderOfTheStruct) {
  const std::string text = to_json_text(fitted_model());
  std::size_t last = 0;
  for (const char* key :
       {"\"name\"", "\"observable\"", "\"reference_temperature_c\"", "\"terms\"", "\"fit\""}) {
    const std::size_t at = text.find(key);
    ASSERT_NE(at, std::string::npos) << key;
    EXPECT_GE(at, last) << key;
    last = at;
  }
}

TEST(ModelFile, WhatAFitCouldNotDetermineSurvivesTheFile) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  ModelFile model = fitted_model();
  model.terms[0].standard_errors["bias"] = kNan;
  model.fit->covariance[1] = {kNan, kNan};
  ChangedFile file;
  const auto back = load_model(file.write(to_json_text(model)));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_TRUE(back->terms[0].standard_errors.empty());
  EXPECT_TRUE(std::isnan(back->fit->covariance[1][1]));
  EXPECT_EQ(back->fit->covariance[0][1], -2e-9);
}

TEST(ModelFile, DefaultsAreTheDocumentedOnes) {
  ChangedFile file;
  const auto model = load_model(file.write(R"({"name": "m", "terms": [{"effect": "bias"}]})"));
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_EQ(model->observable, "rate_deg_per_h");
  EXPECT_EQ(model->reference_temperature_c, 21.0);
  EXPECT_FALSE(model->terms[0].coefficient.has_value());
}

TEST(ModelFile, MistakesAreNamed) {
  EXPECT_THAT(terms_mistake(R"([{"effect": "bias"}, {"effect": "bias"}])"),
              HasSubstr("/terms/1/effect: found \"bias\", expected an effect once; it stands in "
                        "term 0 already"));
  EXPECT_THAT(terms_mistake("[]"), HasSubstr("/terms: found an empty list"));
  EXPECT_THAT(terms_mistake(R"([{"effect": "Bias"}])"),
              HasSubstr("/terms/0/effect: found \"Bias\""));
  EXPECT_THAT(terms_mistake(R"([{"effect": "bias", "coeficient": 1}])"),
              HasSubstr("did you mean \"coefficient\"?"));
  EXPECT_THAT(terms_mistake(R"([{"effect": "bias", "coefficient": null}])"),
              HasSubstr("/terms/0/coefficient: found null, expected a number"));
  EXPECT_THAT(
      terms_mistake(R"([{"effect": "bias", "coefficient": 1, "coefficients": {"cos": 1}}])"),
      HasSubstr("/terms/0/coefficients: stands beside \"coefficient\""));
  EXPECT_THAT(terms_mistake(R"([{"effect": "bias", "fixed": true}])"),
              HasSubstr("/terms/0/fixed: found true, expected a coefficient beside it"));
  EXPECT_THAT(
      terms_mistake(R"([{"effect": "bias", "standard_errors": {"bias": -1}}])"),
      HasSubstr("/terms/0/standard_errors/bias: found -1, expected a number of at least 0"));
}

TEST(ModelFile, CovarianceIsSquareAndNamed) {
  const auto with = [](const std::string& fit) {
    ChangedFile file;
    return message_of(load_model(
        file.write(R"({"name": "m", "terms": [{"effect": "bias"}], "fit": )" + fit + "}")));
  };
  EXPECT_THAT(with(R"({"parameter_names": ["a"], "covariance": [[1, 2]]})"),
              HasSubstr("/fit/covariance/0: found a list of 2, expected a list of 1"));
  EXPECT_THAT(with(R"({"parameter_names": ["a", "b"], "covariance": [[1]]})"),
              HasSubstr("/fit/covariance: found a list of 1, expected 2 rows"));
  // A square of as many columns would not fit into any memory.
  std::string rows = "[]";
  for (int i = 1; i < 200000; ++i) rows += ",[]";
  EXPECT_THAT(with(R"({"parameter_names": ["a"], "covariance": [)" + rows + "]}"),
              HasSubstr("/fit/covariance/0: found an empty list, expected a list of 200000"));
  EXPECT_THAT(with(R"({"parameter_names": ["a"], "covariance": [["1"]]})"),
              HasSubstr("/fit/covariance/0/0: found \"1\", expected a number"));
}

TEST(Limits, MistakesAreNamed) {
  const auto with = [](const std::string& limits) {
    ChangedFile file;
    return message_of(load_limits(file.write(R"({"name": "l", "limits": )" + limits + "}")));
  };
  EXPECT_THAT(with(R"([{"quantity": "K_z"}])"), HasSubstr("/limits/0: has neither \"minimum\""));
  EXPECT_THAT(with(R"([{"quantity": "K_z", "minimum": 2, "maximum": 1}])"),
              HasSubstr("/limits/0/minimum: found 2, expected at most the maximum 1"));
  EXPECT_THAT(with(R"([{"quantity": "K_z", "repeatability": -1}])"),
              HasSubstr("/limits/0/repeatability: found -1"));
  EXPECT_THAT(with(R"([{"quantity": "K_z", "maximum": 1, "tests": 0}])"),
              HasSubstr("/limits/0/tests: found 0"));
  EXPECT_THAT(with(R"([{"quantity": "K_z", "maximum": 1}], "coverage_factor": 0)"),
              HasSubstr("/coverage_factor: found 0"));
  EXPECT_THAT(
      with(R"([{"quantity": "K", "minimum": 2}, {"quantity": "K", "minimum": 1}])"),
      HasSubstr("/limits/1/quantity: found \"K\", expected a quantity that does not stand"));
}

/// The facts that the whole software is first tried on, against the article's figures.
TEST(PublishedData, ModelsHoldThePublishedCoefficients) {
  const auto thermal = load_model(kReady / "models/paper-thermal.json");
  ASSERT_TRUE(thermal) << thermal.error().message;
  std::vector<double> coefficients;
  for (const ModelTerm& term : thermal->terms) coefficients.push_back(term.coefficient.value());
  EXPECT_THAT(coefficients, ElementsAre(1.197, -0.108, 0.004));
  EXPECT_EQ(thermal->reference_temperature_c, 21.0);
  EXPECT_EQ(load_model(kReady / "models/paper-thermal-transient.json")->terms.at(3).coefficient,
            1.997);
  const auto magnetic = load_model(kReady / "models/paper-magnetic-device2.json");
  EXPECT_EQ(magnetic->terms.at(1).coefficient, -0.576);
}

TEST(PublishedData, TablesHoldThePublishedFigures) {
  const auto thermal = read_text_file(kReady / "data/paper-thermal.csv");
  ASSERT_TRUE(thermal) << thermal.error().message;
  EXPECT_EQ(thermal->substr(0, thermal->find('\n')),
            "temperature_c,rate_deg_per_h,sigma_deg_per_h");
  EXPECT_THAT(*thermal, HasSubstr("\n55,1.564,0.019\n"));
  const auto magnetic = read_text_file(kReady / "data/paper-magnetic-device2.csv");
  ASSERT_TRUE(magnetic) << magnetic.error().message;
  EXPECT_THAT(*magnetic, HasSubstr("\n2,coil_y,0,100,0,-0.375\n"));
}

}  // namespace
}  // namespace fogbench::config
