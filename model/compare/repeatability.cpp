#include "model/compare/repeatability.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <numbers>

#include "model/fit/gls.hpp"

namespace fogbench::model {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kSignificant = 0.05;

double chi_squared(const RunCoefficients& a, const RunCoefficients& b, double scale) {
  const VectorXd difference = b.values - scale * a.values;
  const auto n = difference.size();
  const MatrixXd covariance = a.covariance.size() == 0
                                  ? MatrixXd((1.0 + scale * scale) * MatrixXd::Identity(n, n))
                                  : MatrixXd(b.covariance + scale * scale * a.covariance);
  return difference.dot(covariance.ldlt().solve(difference));
}

/// The scale as an angle, so that a vanishing first run is no special case.
double best_scale(const RunCoefficients& a, const RunCoefficients& b) {
  const auto at = [&](double angle) { return chi_squared(a, b, std::tan(angle)); };
  constexpr double kHalfPi = std::numbers::pi / 2.0;
  constexpr int kParts = 90;
  int best = 0;
  for (int i = 1; i < kParts; ++i) {
    if (at(-kHalfPi + (i + 0.5) * 2.0 * kHalfPi / kParts) <
        at(-kHalfPi + (best + 0.5) * 2.0 * kHalfPi / kParts)) {
      best = i;
    }
  }
  const double centre = -kHalfPi + (best + 0.5) * 2.0 * kHalfPi / kParts;
  const double step = 2.0 * kHalfPi / kParts;
  return std::tan(
      boost::math::tools::brent_find_minima(at, centre - step, centre + step, 40).first);
}

double upper_tail_chi2(double chi2, double degrees) {
  return boost::math::cdf(
      boost::math::complement(boost::math::chi_squared(degrees), std::max(chi2, 0.0)));
}

std::string probability(double p) {
  return p < 1e-4 ? "p < 0.0001" : fmt::format("p = {:.2g}", p);
}

}  // namespace

RunChange change_between(const RunCoefficients& a, const RunCoefficients& b,
                         const std::vector<std::string>& names, const std::string& unit) {
  RunChange change{.run_a = a.run, .run_b = b.run};
  const double product = a.values.norm() * b.values.norm();
  const double cosine = product > 0.0 ? a.values.dot(b.values) / product : 1.0;
  change.angle_deg = std::acos(std::clamp(cosine, -1.0, 1.0)) * 180.0 / std::numbers::pi;
  change.common_scale = best_scale(a, b);
  const double n = static_cast<double>(a.values.size());
  const double repeat = chi_squared(a, b, 1.0);
  const double scaled = chi_squared(a, b, change.common_scale);
  const bool noise_known = a.covariance.size() > 0;
  // Without known noise chi-squared is in units of the unknown variance: what is left under one
  // common scale estimates it.
  const double variance = noise_known ? 1.0 : scaled / (n - 1.0);
  const double gain = variance > 0.0 ? (repeat - scaled) / variance : 0.0;
  // Where noise is known, two questions share one rate: a common scale, and any change at all.
  const double questions = noise_known ? 2.0 : 1.0;
  const double p_scale =
      noise_known || gain <= 0.0
          ? std::min(1.0, questions * upper_tail_chi2(gain, 1.0))
          : boost::math::cdf(boost::math::complement(boost::math::fisher_f(1.0, n - 1.0), gain));
  const double p_left = noise_known ? upper_tail_chi2(scaled, n - 1.0) : 1.0;

  constexpr double kStep = 1e-3;
  const double curvature = (chi_squared(a, b, change.common_scale + kStep) - 2.0 * scaled +
                            chi_squared(a, b, change.common_scale - kStep)) /
                           (kStep * kStep);
  change.scale_standard_error = curvature > 0.0 ? std::sqrt(2.0 * variance / curvature) : 0.0;
  change.p_repeat = noise_known ? std::min(1.0, questions * upper_tail_chi2(repeat, n)) : p_scale;
  change.scale_changed = p_scale < kSignificant;

  const std::string yardstick =
      noise_known ? ""
                  : " (no noise is stated: the yardstick is what one common scale leaves "
                    "unexplained, taken to be equal for all coefficients)";
  const std::string list = fmt::format("{}", fmt::join(names, ", "));
  const std::string from_to = fmt::format("From {0} {1} to {0} {2}", a.word, a.run, b.run);
  if (change.scale_changed && p_left >= 0.01) {
    change.says = fmt::format(
        "{} the coefficients {} {} together: one common scale {:.2f} +- {:.2f} "
        "explains the change, their direction is kept to {:.1f} deg. That is not noise ({}){}.",
        from_to, list, std::abs(change.common_scale) < 1.0 ? "shrank" : "grew", change.common_scale,
        change.scale_standard_error, change.angle_deg, probability(p_scale), yardstick);
  } else if (change.p_repeat < kSignificant) {
    change.says = fmt::format(
        "{} the coefficients {} changed by more than noise explains ({}), and "
        "one common scale ({:.2f}) does not explain how: their direction turned by {:.1f} deg.",
        from_to, list, probability(change.p_repeat), change.common_scale, change.angle_deg);
  } else {
    change.says = fmt::format(
        "{} the coefficients {} did not change by more than noise explains "
        "({}){}. RMS difference {:.2g} {}.",
        from_to, list, probability(change.p_repeat), yardstick,
        (b.values - a.values).norm() / std::sqrt(n), unit);
  }
  return change;
}

std::vector<std::string> judge_by_scatter(const std::vector<RunCoefficients>& runs,
                                          const std::vector<std::string>& names,
                                          const std::string& unit) {
  const double count = static_cast<double>(runs.size());
  const auto n = runs.front().values.size();
  VectorXd mean = VectorXd::Zero(n);
  for (const RunCoefficients& run : runs) mean += run.values / count;
  double squares = 0.0;
  for (const RunCoefficients& run : runs) squares += (run.values - mean).squaredNorm();
  const double degrees = (count - 1.0) * static_cast<double>(n);
  const double sigma = std::sqrt(squares / degrees);
  const double error = sigma / std::sqrt(count);
  const boost::math::students_t student(degrees);
  const double factor = boost::math::quantile(student, 0.5 + 0.5 * kTwoSigma);
  std::vector<std::string> out{fmt::format(
      "The table states no noise, so the scatter between the {} runs is the only yardstick: "
      "{:.2g} {} for one run, taken to be equal for all coefficients ({:.0f} degrees of freedom).",
      runs.size(), sigma, unit, degrees)};
  for (Eigen::Index k = 0; k < n; ++k) {
    std::vector<std::string> values;
    for (const RunCoefficients& run : runs) values.push_back(fmt::format("{:.3g}", run.values[k]));
    const bool zero = std::abs(mean[k]) <= factor * error;
    out.push_back(fmt::format(
        "{}: {} in the runs, mean {:.2g} +- {:.2g} {} (95 %): {}.",
        names[static_cast<std::size_t>(k)], fmt::join(values, " and "), mean[k], factor * error,
        unit, zero ? "not distinguishable from zero" : "distinguishable from zero"));
  }
  return out;
}

}  // namespace fogbench::model
