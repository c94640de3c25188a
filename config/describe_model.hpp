#pragma once
// The JSON shape of model files (model_file.hpp) and of limits (limits.hpp).

#include "config/codec.hpp"
#include "config/describe_scenario.hpp"
#include "config/limits.hpp"
#include "config/model_file.hpp"

namespace fogbench::config {

/// Square, row by row; null where the fit could not determine a value.
struct Covariance {
  std::vector<std::vector<double>>& rows;
};

template <>
struct Codec<Covariance> {
  static bool read(const Place& at, Covariance& out, const Rule& rule);
  static ordered_json schema(const Rule& rule);
  static ordered_json write(const Covariance& covariance);
};

template <class Visitor>
void describe(Visitor& v, ModelTerm& t) {
  v.required("effect", t.effect,
             "Identifier of an effect, as in `fogbench effects`, or a name for the expression.");
  v.optional("coefficient", t.coefficient, "Without one, the term is fitted.");
  v.optional("coefficients", t.coefficients, "By column, for an effect with several: cos and sin.");
  v.optional("fixed", t.fixed, "Holds the coefficient in a fit.");
  v.optional("parameters", t.parameters,
             "Inner parameters: starting values going in, estimates coming out.");
  v.optional("expression", t.expression,
             "A formula over the table's columns, for an effect that the catalogue lacks.");
  v.optional("unit", t.unit,
             "Unit of the coefficient: what an expression's is; an effect of the catalogue has its "
             "own, and another is refused.");
  v.optional("standard_errors", t.standard_errors,
             "Written by a fit, by coefficient and inner parameter; what it could not determine "
             "is left out.",
             at_least(0));
}

template <class Visitor>
void describe(Visitor& v, FitRecord& f) {
  v.optional("data", f.data, "File or run that was fitted.");
  v.optional("data_sha256", f.data_sha256, "Its hash.");
  v.optional("read_as", f.read_as, "What was recognised in the files: dialect, names, units.");
  v.optional("fitted_at", f.fitted_at, "ISO 8601, UTC.");
  v.optional("software_version", f.software_version, "Of fogbench.");
  v.optional("parameter_names", f.parameter_names, "Rows and columns of the covariance.");
  Covariance covariance{f.covariance};
  v.optional("covariance", covariance, "Of the fitted numbers.");
  v.optional("noise", f.noise, "Noise that the fit found.");
  v.optional("rms_deg_per_h", f.rms_deg_per_h, "Root of the mean squared residual.", at_least(0));
  v.optional("degrees_of_freedom", f.degrees_of_freedom, "Of the residual.", at_least(0));
  v.optional("rows", f.rows, "Rows of the table that took part.");
}

template <class Visitor>
void describe(Visitor& v, ModelFile& m) {
  v.required("name", m.name, "Short name.");
  v.optional("description", m.description, "Where the model comes from, in a sentence.");
  v.optional("observable", m.observable, "Column of the table that the model explains.");
  v.optional("reference_temperature_c", m.reference_temperature_c,
             "Temperature that the thermal terms count from.");
  v.required("terms", m.terms, "The sum that makes the observable.", not_empty());
  v.optional("fit", m.fit, "Written by a fit.");
}

template <class Visitor>
void describe(Visitor& v, Limit& l) {
  v.required("quantity", l.quantity, "A result: magnetic_linear_z, temperature_sigma, K_z.");
  v.optional("minimum", l.minimum, "Lowest value that passes.");
  v.optional("maximum", l.maximum, "Highest value that passes.");
  v.optional("repeatability", l.repeatability,
             "Largest change from one test to the next that passes, either way.", at_least(0));
  v.optional("tests", l.tests, "In how many tests, where it is not the file's number.",
             at_least(1));
  v.optional("unit", l.unit, "Of the limits, as the results have it.");
}

template <class Visitor>
void describe(Visitor& v, LimitsConfig& l) {
  v.required("name", l.name, "Short name.");
  v.optional("description", l.description, "Where the limits come from, in a sentence.");
  v.optional("coverage_factor", l.coverage_factor,
             "Of the expanded uncertainty, the guard band at each limit; 2 without it.", above(0));
  v.optional("tests", l.tests, "In how many tests each quantity has to be measured; 1 without it.",
             at_least(1));
  v.required("limits", l.limits, "One entry a quantity.", not_empty());
}

bool check(const Place& at, const ModelTerm& term);
bool check(const Place& at, const FitRecord& fit);
bool check(const Place& at, const ModelFile& model);
bool check(const Place& at, const Limit& limit);
bool check(const Place& at, const LimitsConfig& limits);

}  // namespace fogbench::config
