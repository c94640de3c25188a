#include "model/compare/difference.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <numbers>

namespace fogbench::model {
namespace {

/// The free estimates of a fit by name, with their rows of the covariance.
struct Known {
  const Estimate* estimate = nullptr;
  Eigen::Index row = -1;
};

std::vector<Known> free_estimates(const FitResult& fit) {
  std::vector<Known> out;
  for (const Estimate& e : fit.estimates) {
    if (!e.held) out.push_back({&e, static_cast<Eigen::Index>(out.size())});
  }
  return out;
}

bool determined(const Known& known) {
  return known.estimate != nullptr && std::isfinite(known.estimate->value) &&
         std::isfinite(known.estimate->standard_error);
}

double expanded(const Estimate& e) {
  return e.coverage_factor * e.standard_error;
}

/// Of these rows, widened as Student's t is where few degrees of freedom estimated it.
Eigen::MatrixXd covariance_of(const FitResult& fit, const std::vector<Known>& chosen) {
  std::vector<Eigen::Index> rows;
  Eigen::VectorXd wider(static_cast<Eigen::Index>(chosen.size()));
  for (const Known& one : chosen) {
    wider[static_cast<Eigen::Index>(rows.size())] = 0.5 * one.estimate->coverage_factor;
    rows.push_back(one.row);
  }
  return wider.asDiagonal() * fit.covariance(rows, rows) * wider.asDiagonal();
}

}  // namespace

Difference difference_between(const FitResult& a, const FitResult& b) {
  Difference out;
  std::vector<Known> of_a, of_b;
  const std::vector<Known> others = free_estimates(b);
  for (const Known& first : free_estimates(a)) {
    const auto same = std::find_if(others.begin(), others.end(), [&](const Known& other) {
      return other.estimate->name == first.estimate->name;
    });
    if (!determined(first) || same == others.end() || !determined(*same)) {
      out.not_in_both.push_back(first.estimate->name);
      continue;
    }
    of_a.push_back(first);
    of_b.push_back(*same);
    const Estimate &x = *first.estimate, &y = *same->estimate;
    out.coefficients.push_back({.name = x.name,
                                .unit = x.unit,
                                .a = x.value,
                                .expanded_a = expanded(x),
                                .b = y.value,
                                .expanded_b = expanded(y),
                                .difference = y.value - x.value,
                                .expanded_uncertainty = std::hypot(expanded(x), expanded(y))});
  }
  const auto n = static_cast<Eigen::Index>(out.coefficients.size());
  if (n == 0) return out;
  Eigen::VectorXd difference(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    CoefficientDifference& one = out.coefficients[static_cast<std::size_t>(k)];
    difference[k] = one.difference;
    const double z = 2.0 * std::abs(one.difference) / one.expanded_uncertainty;
    const double p = std::erfc(z / std::numbers::sqrt2);
    one.p_of_all = -std::expm1(static_cast<double>(n) * std::log1p(-p));
  }
  // In units of each difference's own error: coefficients differ by many powers of ten.
  Eigen::MatrixXd covariance = covariance_of(a, of_a) + covariance_of(b, of_b);
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  covariance = scale.asDiagonal() * covariance * scale.asDiagonal();
  const Eigen::VectorXd scaled = scale.cwiseProduct(difference);
  const double chi2 = scaled.dot(covariance.ldlt().solve(scaled));
  out.p_same = boost::math::cdf(boost::math::complement(
      boost::math::chi_squared(static_cast<double>(n)), std::max(chi2, 0.0)));
  return out;
}

}  // namespace fogbench::model
