// Certified regression problems (NIST StRD), each through the public path: a CSV file, a model and
// fit(). tests/data/nist holds the data and the certified values with their source.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "model/fit/fit.hpp"
#include "model/table/read_table.hpp"
#include "tests/support/source_tree.hpp"

namespace fogbench::model {
namespace {

using config::ModelFile;
using config::ModelTerm;
using nlohmann::json;

const std::string kFolder = (tests::source_tree() / "tests/data/nist").string() + "/";

json problems(const std::string& file) {
  std::ifstream in(kFolder + file);
  return json::parse(in).at("problems");
}

Table problem_table(const json& problem) {
  std::string name = problem.at("name");
  std::transform(name.begin(), name.end(), name.begin(), [](char c) { return std::tolower(c); });
  auto table = read_table(kFolder + name + ".csv");
  EXPECT_TRUE(table) << (table ? "" : table.error().message);
  return table ? *table : Table{};
}

/// The starting values of those parameters that the formula uses.
std::map<std::string, double> used_in(const std::string& formula, const json& start) {
  std::map<std::string, double> used;
  for (const auto& [name, value] : start.items()) {
    for (std::size_t at = formula.find(name); at != std::string::npos;
         at = formula.find(name, at + 1)) {
      const std::size_t end = at + name.size();
      if (end == formula.size() || std::isdigit(formula[end]) == 0) used[name] = value;
    }
  }
  return used;
}

/// Coefficients b_k as coefficients of their own terms, the others as inner parameters.
ModelFile separable_model(const json& problem, const json& start) {
  ModelFile model;
  model.observable = problem.at("observable");
  for (const json& part : problem.at("separable")) {
    ModelTerm term;
    term.effect = part.at("name");
    term.expression = part.at("expression");
    term.parameters = used_in(*term.expression, start);
    if (!problem.at("certified").contains(term.effect)) {
      term.coefficient = 1.0;
      term.fixed = true;
    }
    model.terms.push_back(std::move(term));
  }
  return model;
}

/// The whole formula as one term of coefficient 1: every parameter is an inner one.
ModelFile formula_model(const json& problem, const json& start) {
  ModelFile model;
  model.observable = problem.at("observable");
  ModelTerm term;
  term.effect = "formula";
  term.expression = problem.at("formula");
  term.parameters = used_in(*term.expression, start);
  term.coefficient = 1.0;
  term.fixed = true;
  model.terms.push_back(std::move(term));
  return model;
}

/// Correct significant digits, at most 11: the certified values have no more.
double digits(double found, double certified) {
  const double error = certified == 0.0 ? std::abs(found) : std::abs(found / certified - 1.0);
  if (std::isnan(error)) return 0.0;
  return std::clamp(-std::log10(std::max(error, 1e-16)), 0.0, 11.0);
}

struct Agreement {
  double coefficients = 11.0, errors = 11.0, rss = 0.0;
};

Agreement agreement(const json& problem, const ModelFile& model) {
  Agreement least;
  // The certified values are those of all rows, the doubtful ones included.
  const auto result = fit(problem_table(problem), model, {.weight_by = {}, .doubt_rows = false});
  EXPECT_TRUE(result) << problem.at("name") << ": " << (result ? "" : result.error().message);
  if (!result) return {0.0, 0.0, 0.0};
  for (const auto& [name, certified] : problem.at("certified").items()) {
    const auto found = std::find_if(result->estimates.begin(), result->estimates.end(),
                                    [&name = name, inner = "." + name](const Estimate& e) {
                                      return !e.held && (e.name == name || e.name.ends_with(inner));
                                    });
    if (found == result->estimates.end()) {
      ADD_FAILURE() << problem.at("name") << ": no estimate of " << name;
      continue;
    }
    least.coefficients = std::min(least.coefficients, digits(found->value, certified[0]));
    least.errors = std::min(least.errors, digits(found->standard_error, certified[1]));
  }
  least.rss = digits(result->residual_sum_of_squares, problem.at("residual_sum_of_squares"));
  EXPECT_EQ(result->degrees_of_freedom, problem.at("degrees_of_freedom").get<double>());
  return least;
}

TEST(Nist, LinearProblemsAgreeToSixDigits) {
  for (const json& problem : problems("linear.json")) {
    const Agreement found = agreement(problem, separable_model(problem, json::object()));
    EXPECT_GE(found.coefficients, 6.0) << problem.at("name");
    RecordProperty(problem.at("name"), std::to_string(found.coefficients));
    // Wampler1 and 2 are exact: their certified errors are zero.
    const bool exact = problem.at("residual_sum_of_squares") == 0.0;
    EXPECT_GE(found.errors, exact ? 5.0 : 6.0) << problem.at("name");
    EXPECT_GE(found.rss, 6.0) << problem.at("name");
  }
}

TEST(Nist, NonlinearProblemsAgreeToSixDigitsFromBothStarts) {
  for (const json& problem : problems("nonlinear.json")) {
    if (problem.at("separable").empty()) continue;
    for (const json& start : problem.at("start")) {
      const Agreement found = agreement(problem, separable_model(problem, start));
      EXPECT_GE(found.coefficients, 6.0) << problem.at("name") << " from " << start;
      // The residuals of Lanczos1 are the 14th digit of its data: so few digits of the standard
      // deviations are left after rounding.
      const double least = problem.at("name") == "Lanczos1" ? 3.0 : 5.0;
      EXPECT_GE(found.errors, least) << problem.at("name") << " from " << start;
    }
  }
}

// As one formula the sums of exponentials and of waves, and the rational functions, have minima in
// which the terms change places, or are far below rounding: terms with coefficients of their own
// (above) are the way to fit those.
TEST(Nist, FormulasOfUpToFourInnerParametersAgreeToSixDigitsFromBothStarts) {
  for (const json& problem : problems("nonlinear.json")) {
    if (problem.at("certified").size() > 4) continue;
    for (const json& start : problem.at("start")) {
      const Agreement found = agreement(problem, formula_model(problem, start));
      EXPECT_GE(found.coefficients, 6.0) << problem.at("name") << " from " << start;
    }
  }
}

}  // namespace
}  // namespace fogbench::model
