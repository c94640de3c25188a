#include "model/fit/fitted_model.hpp"

#include <cmath>

namespace fogbench::model {

config::ModelFile fitted_model(const config::ModelFile& model, const Design& design,
                               const FitResult& result) {
  config::ModelFile fitted = model;
  const std::vector<DesignColumn>& columns = design.columns();
  const std::size_t own = design.own_columns();
  std::vector<bool> present(fitted.terms.size(), false);
  for (config::ModelTerm& term : fitted.terms) term.standard_errors.clear();
  for (std::size_t i = 0; i < own; ++i) {
    config::ModelTerm& term = fitted.terms[columns[i].term];
    const Estimate& estimate = result.estimates[i];
    const bool known = !std::isnan(estimate.value);
    present[columns[i].term] = present[columns[i].term] || known;
    const double value = known ? estimate.value : 0.0;
    if (columns[i].key.empty()) {
      term.coefficient = value;
    } else {
      term.coefficients[columns[i].key] = value;
    }
    if (std::isfinite(estimate.standard_error)) {
      const std::string key = columns[i].key.empty() ? "coefficient" : columns[i].key;
      term.standard_errors[key] = estimate.standard_error;
    }
  }
  for (std::size_t i = 0; i < design.parameters().size(); ++i) {
    const DesignParameter& parameter = design.parameters()[i];
    const Estimate& estimate = result.estimates[own + i];
    for (config::ModelTerm& term : fitted.terms) {
      const bool declares = term.expression && term.parameters.contains(parameter.key);
      const bool owns = term.effect + "." + parameter.key == parameter.name;
      const bool shares = parameter.range ? owns : declares;
      if (!shares) continue;
      term.parameters[parameter.key] = estimate.value;
      if (std::isfinite(estimate.standard_error)) {
        term.standard_errors[parameter.key] = estimate.standard_error;
      }
    }
  }
  for (std::size_t i = fitted.terms.size(); i-- > 0;) {
    if (!present[i]) fitted.terms.erase(fitted.terms.begin() + static_cast<long>(i));
  }
  config::FitRecord record;
  std::vector<Eigen::Index> determined;
  Eigen::Index next = 0;
  for (const Estimate& estimate : result.estimates) {
    if (estimate.held) continue;
    if (std::isfinite(estimate.standard_error)) {
      record.parameter_names.push_back(estimate.name);
      determined.push_back(next);
    }
    ++next;
  }
  for (const Eigen::Index i : determined) {
    std::vector<double> row;
    for (const Eigen::Index j : determined) row.push_back(result.covariance(i, j));
    record.covariance.push_back(std::move(row));
  }
  record.noise = result.noise.noise;
  record.rms_deg_per_h = result.rms;
  record.degrees_of_freedom = result.degrees_of_freedom;
  record.rows = result.rows.size();
  fitted.fit = std::move(record);
  return fitted;
}

}  // namespace fogbench::model
