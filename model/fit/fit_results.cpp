#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "config/rounding.hpp"
#include "model/fit/fit_work.hpp"

namespace fogbench::model {
namespace {

/// Beyond this correlation two estimates are reported as nearly inseparable.
constexpr double kCorrelated = 0.98;
/// A residual below this part of the largest measurement is rounding.
constexpr double kRounding = 1e-12;
/// Times the range of the measurements: one degree, one 100 uT, one hour of a term should not be
/// able to move them by more.
constexpr double kFarBeyond = 10.0;

/// All columns' coefficients, held and free.
Eigen::VectorXd all_coefficients(const FitWork& work) {
  const std::vector<DesignColumn>& columns = work.design.columns();
  Eigen::VectorXd all(static_cast<Eigen::Index>(columns.size()));
  Eigen::Index next = 0;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    all[static_cast<Eigen::Index>(i)] = columns[i].held ? *columns[i].given : work.beta[next++];
  }
  return all;
}

}  // namespace

void fill_residuals(FitWork& work) {
  FitResult& result = work.result;
  const Eigen::VectorXd everywhere = work.design.predict(all_coefficients(work), work.inner);
  const std::vector<std::size_t>& taken = work.observations.taken();
  const auto count = static_cast<Eigen::Index>(taken.size());
  result.predicted.resize(count);
  result.rows.resize(taken.size());
  for (std::size_t i = 0; i < taken.size(); ++i) {
    result.rows[i] = work.signals.table_row(taken[i]);
    result.predicted[static_cast<Eigen::Index>(i)] =
        everywhere[static_cast<Eigen::Index>(taken[i])];
  }
  result.residual = work.observations.observed() - result.predicted;
  result.residual_sum_of_squares = result.residual.squaredNorm();
  result.rms = std::sqrt(result.residual_sum_of_squares / static_cast<double>(count));
  result.residual_standard_deviation =
      result.degrees_of_freedom > 0.0
          ? std::sqrt(result.residual_sum_of_squares / result.degrees_of_freedom)
          : kMissing;
}

void fill_independent_noise(FitWork& work) {
  FitResult& result = work.result;
  const Eigen::VectorXd& sigma = work.observations.sigma();
  const Eigen::VectorXd scale =
      sigma.size() > 0 ? sigma : Eigen::VectorXd::Ones(result.residual.size());
  const double dof = result.degrees_of_freedom;
  const double factor =
      dof > 0.0 ? std::sqrt(result.residual.cwiseQuotient(scale).squaredNorm() / dof) : kMissing;
  result.standard_deviation = factor * scale;
  result.whitened = result.residual.cwiseQuotient(result.standard_deviation);
  result.noise.says = "independent, its size estimated from the residual";
}

Status fill_coloured_noise(FitWork& work) {
  FitResult& result = work.result;
  Result<std::unique_ptr<Whitener>> whitener =
      make_whitener(work.observations.windows(), result.noise.noise);
  if (!whitener) return whitener.error();
  result.windows = work.observations.windows();
  result.window_of = work.observations.bin_of();
  result.white_beside_windows = 0.0;
  for (std::size_t i = 0; i < result.window_of.size(); ++i) {
    result.white_beside_windows += 3600.0 / work.observations.length_s(i) -
                                   3600.0 / result.windows.duration_s[result.window_of[i]];
  }
  result.white_beside_windows /= static_cast<double>(result.window_of.size());
  const Eigen::VectorXd deviation = (*whitener)->standard_deviation();
  const std::vector<Eigen::Index>& bin_of = work.observations.bin_of();
  if (work.observations.windows().rows() == result.residual.size()) {
    result.standard_deviation = deviation;
    result.whitened = (*whitener)->whiten(result.residual);
    return {};
  }
  const double n = result.noise.noise.angle_random_walk_deg_per_sqrt_h;
  result.standard_deviation.resize(result.residual.size());
  for (std::size_t i = 0; i < bin_of.size(); ++i) {
    const double own = work.observations.length_s(i);
    const double joined = work.observations.windows().duration_s[bin_of[i]];
    const double white = n * n * 3600.0 * (1.0 / own - 1.0 / joined);
    result.standard_deviation[static_cast<Eigen::Index>(i)] =
        std::sqrt(deviation[bin_of[i]] * deviation[bin_of[i]] + white);
  }
  result.whitened = result.residual.cwiseQuotient(result.standard_deviation);
  return {};
}

void fill_estimates(FitWork& work) {
  FitResult& result = work.result;
  const auto error_of = [&](Eigen::Index i) { return std::sqrt(work.covariance(i, i)); };
  Eigen::Index next = 0;
  std::vector<Eigen::Index> reported;  // of the free columns and inner parameters
  for (std::size_t i = 0; i < work.design.own_columns(); ++i) {
    const DesignColumn& column = work.design.columns()[i];
    if (column.held) {
      result.estimates.push_back({column.name, column.unit, *column.given, 0.0, 2.0, true});
      continue;
    }
    // A column that was left out has no covariance and a zero coefficient.
    const bool left_out = std::isnan(work.covariance(next, next)) && work.beta[next] == 0.0;
    result.estimates.push_back({column.name, column.unit, left_out ? kMissing : work.beta[next],
                                error_of(next), work.coverage, false});
    if (next < work.variance_at_inner.size()) {
      result.estimates.back().error_at_inner = std::sqrt(work.variance_at_inner[next]);
    }
    reported.push_back(next++);
  }
  next = work.free();  // past the starts
  for (std::size_t i = 0; i < work.design.parameters().size(); ++i, ++next) {
    reported.push_back(next);
    const DesignParameter& parameter = work.design.parameters()[i];
    const double value = work.inner[static_cast<Eigen::Index>(i)];
    result.estimates.push_back(
        {parameter.name, parameter.unit, value, error_of(next), work.coverage, false, true});
    if (std::isnan(error_of(next)) && result.degrees_of_freedom > 0.0) {
      result.warnings.push_back(
          fmt::format("{} has no influence on these data: it is not determined", parameter.name));
    }
    if (!parameter.range) continue;
    const double slack = 1e-3 * (parameter.range->maximum - parameter.range->minimum);
    const bool log_scale = parameter.range->logarithmic;
    const double low =
        log_scale ? parameter.range->minimum * 1.001 : parameter.range->minimum + slack;
    const double high =
        log_scale ? parameter.range->maximum * 0.999 : parameter.range->maximum - slack;
    if (value <= low || value >= high) {
      result.warnings.push_back(fmt::format(
          "{} = {:.4g} {} lies at the edge of its range {:.4g}..{:.4g} or outside: these data do "
          "not identify it",
          parameter.name, value, parameter.unit, parameter.range->minimum,
          parameter.range->maximum));
    }
  }
  result.covariance = work.covariance(reported, reported);
}

void warn_of_correlation(FitResult& result) {
  std::vector<std::string> names;
  for (const Estimate& estimate : result.estimates) {
    if (!estimate.held) names.push_back(estimate.name);
  }
  for (Eigen::Index i = 0; i < result.covariance.rows(); ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      const double product = result.covariance(i, i) * result.covariance(j, j);
      const double r = product > 0.0 ? result.covariance(i, j) / std::sqrt(product) : 0.0;
      if (std::abs(r) > kCorrelated) {
        result.warnings.push_back(
            fmt::format("{} and {} are nearly inseparable: correlation {:.4f}",
                        names[static_cast<std::size_t>(j)], names[static_cast<std::size_t>(i)], r));
      }
    }
  }
}

void warn_of_little_evidence(FitResult& result) {
  const Eigen::VectorXd observed = result.predicted + result.residual;
  if (observed.size() == 0) return;
  const double largest = observed.cwiseAbs().maxCoeff();
  if (result.residual.cwiseAbs().maxCoeff() <= kRounding * largest) {
    result.warnings.push_back(
        "the model meets every row exactly: nothing is left to tell the uncertainties from");
    return;
  }
  const double range = observed.maxCoeff() - observed.minCoeff();
  for (const Estimate& e : result.estimates) {
    const double expanded = e.coverage_factor * e.standard_error;
    if (e.held || !(expanded > std::max(std::abs(e.value), kFarBeyond * range))) continue;
    const config::Rounded r = config::rounded(e.value, expanded);
    result.warnings.push_back(
        fmt::format("{} = {} +- {} {} is not determined by these data: its term hardly varies, or "
                    "others can stand for it",
                    e.name, r.value, r.uncertainty, e.unit));
  }
}

config::ModelFile fitted_model(const FitWork& work) {
  const FitResult& result = work.result;
  config::ModelFile fitted = work.model;
  const std::vector<DesignColumn>& columns = work.design.columns();
  const std::size_t own = work.design.own_columns();
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
  for (std::size_t i = 0; i < work.design.parameters().size(); ++i) {
    const DesignParameter& parameter = work.design.parameters()[i];
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
