#include "model/fit/fit_warnings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "config/rounding.hpp"

namespace fogbench::model {
namespace {

/// Beyond this correlation two estimates are reported as nearly inseparable.
constexpr double kCorrelated = 0.98;
/// A residual below this part of the largest measurement is rounding.
constexpr double kRounding = 1e-12;
/// Times the range of the measurements: one degree, one 100 uT, one hour of a term should not be
/// able to move them by more.
constexpr double kFarBeyond = 10.0;

void warn_of_correlation(const FitResult& result, std::vector<std::string>& warnings) {
  std::vector<std::string> names;
  for (const Estimate& estimate : result.estimates) {
    if (!estimate.held) names.push_back(estimate.name);
  }
  for (Eigen::Index i = 0; i < result.covariance.rows(); ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      const double product = result.covariance(i, i) * result.covariance(j, j);
      const double r = product > 0.0 ? result.covariance(i, j) / std::sqrt(product) : 0.0;
      if (std::abs(r) > kCorrelated) {
        warnings.push_back(fmt::format("{} and {} are nearly inseparable: correlation {:.4f}",
                                       names[static_cast<std::size_t>(j)],
                                       names[static_cast<std::size_t>(i)], r));
      }
    }
  }
}

/// Of an exact fit, and of coefficients whose uncertainty exceeds themselves and, for one unit of
/// their term, anything that was measured.
void warn_of_little_evidence(const FitResult& result, std::vector<std::string>& warnings) {
  const Eigen::VectorXd observed = result.predicted + result.residual;
  if (observed.size() == 0) return;
  const double largest = observed.cwiseAbs().maxCoeff();
  if (result.residual.cwiseAbs().maxCoeff() <= kRounding * largest) {
    warnings.push_back(
        "the model meets every row exactly: nothing is left to tell the uncertainties from");
    return;
  }
  const double range = observed.maxCoeff() - observed.minCoeff();
  for (const Estimate& e : result.estimates) {
    const double expanded = e.coverage_factor * e.standard_error;
    if (e.held || !(expanded > std::max(std::abs(e.value), kFarBeyond * range))) continue;
    const config::Rounded r = config::rounded(e.value, expanded);
    warnings.push_back(
        fmt::format("{} = {} +- {} {} is not determined by these data: its term hardly varies, or "
                    "others can stand for it",
                    e.name, r.value, r.uncertainty, e.unit));
  }
}

}  // namespace

std::vector<std::string> weak_evidence(const FitResult& result) {
  std::vector<std::string> warnings;
  warn_of_correlation(result, warnings);
  warn_of_little_evidence(result, warnings);
  return warnings;
}

}  // namespace fogbench::model
