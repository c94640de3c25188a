#include "model/noise/allan.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "config/units.hpp"

namespace fogbench::model {
namespace {

constexpr int kCoefficients = 4;  // N^2, B^2, K^2, Q^2

/// Equivalent degrees of freedom of the overlapping estimator for white rate noise,
/// SP 1065 table 5; `samples` of phase, tau of m intervals.
double degrees_of_freedom(double samples, double m) {
  const double edf = (1.5 * (samples - 1.0) / m - 2.0 * (samples - 2.0) / samples) * 4.0 * m * m /
                     (4.0 * m * m + 5.0);
  return std::max(edf, 1.0);
}

/// The formula's columns at tau: N^2, B^2, K^2, Q^2 each times its entry make sigma^2.
Eigen::RowVector4d terms_at(double tau_s) {
  const double tau = tau_s / config::kSecondsPerHour;
  const double flicker = 2.0 * std::numbers::ln2 / std::numbers::pi;  // 0.664^2
  return {1.0 / tau, flicker, tau / 3.0, 3.0 / (tau * tau)};
}

struct Subset {
  std::vector<int> columns;
  Eigen::VectorXd values;
  double misfit = std::numeric_limits<double>::infinity();
};

/// Non-negative least squares by trying all sets of positive coefficients: there are only fifteen.
Subset non_negative_fit(const Eigen::MatrixXd& a, const Eigen::VectorXd& y) {
  Subset best;
  for (unsigned mask = 1; mask < (1u << kCoefficients); ++mask) {
    Subset trial;
    for (int c = 0; c < kCoefficients; ++c) {
      if (mask & (1u << c)) trial.columns.push_back(c);
    }
    const Eigen::MatrixXd chosen = a(Eigen::all, trial.columns);
    const Eigen::VectorXd scale = chosen.colwise().norm().cwiseInverse();
    trial.values = scale.cwiseProduct((chosen * scale.asDiagonal()).colPivHouseholderQr().solve(y));
    trial.misfit = (y - chosen * trial.values).squaredNorm();
    if (trial.values.minCoeff() > 0.0 && trial.misfit < best.misfit) best = trial;
  }
  return best;
}

}  // namespace

Result<std::vector<AllanPoint>> allan_deviation(std::span<const double> rate, double interval_s,
                                                bool all_tau) {
  const std::size_t n = rate.size();
  if (n < 3) return config::bad_input(fmt::format("{} samples: at least 3 were expected", n));
  if (!(interval_s > 0.0) || !std::isfinite(interval_s)) {
    return config::bad_input(
        fmt::format("sampling interval {} s: a positive number was expected", interval_s));
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (!std::isfinite(rate[i])) {
      return config::bad_input(
          fmt::format("sample {} is {}: a number was expected", i + 1, rate[i]));
    }
  }
  // Phase in intervals; the mean, which second differences do not see, is taken out for precision.
  const double mean = std::accumulate(rate.begin(), rate.end(), 0.0) / static_cast<double>(n);
  std::vector<double> phase(n + 1, 0.0);
  for (std::size_t i = 0; i < n; ++i) phase[i + 1] = phase[i] + (rate[i] - mean);
  std::vector<AllanPoint> curve;
  for (std::size_t m = 1; 3 * m <= n; m = all_tau ? m + 1 : 2 * m) {
    const std::size_t count = n + 1 - 2 * m;
    double sum = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const double difference = phase[i + 2 * m] - 2.0 * phase[i + m] + phase[i];
      sum += difference * difference;
    }
    const double md = static_cast<double>(m);
    const double deviation = std::sqrt(sum / (2.0 * static_cast<double>(count))) / md;
    curve.push_back(
        {.tau_s = md * interval_s,
         .deviation_deg_per_h = deviation,
         .standard_error_deg_per_h =
             deviation / std::sqrt(2.0 * degrees_of_freedom(static_cast<double>(n + 1), md)),
         .count = count});
  }
  return curve;
}

Result<AllanFit> fit_allan(std::span<const AllanPoint> curve) {
  std::vector<AllanPoint> points;
  for (const AllanPoint& point : curve) {
    if (point.deviation_deg_per_h > 0.0 && point.standard_error_deg_per_h > 0.0) {
      points.push_back(point);
    }
  }
  const auto rows = static_cast<Eigen::Index>(points.size());
  if (rows < kCoefficients) {
    return config::bad_input(fmt::format(
        "{} points of positive Allan deviation: at least {} were expected", rows, kCoefficients));
  }
  Eigen::MatrixXd a(rows, kCoefficients);
  Eigen::VectorXd variance(rows), relative(rows), log_tau(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const AllanPoint& point = points[static_cast<std::size_t>(i)];
    a.row(i) = terms_at(point.tau_s);
    variance[i] = point.deviation_deg_per_h * point.deviation_deg_per_h;
    relative[i] = 2.0 * point.standard_error_deg_per_h / point.deviation_deg_per_h;
    log_tau[i] = std::log2(point.tau_s);
  }
  // A point that happens to lie low must not weigh more for it: errors follow the fitted curve.
  constexpr int kIterations = 3;
  Eigen::VectorXd expected = variance;
  Subset fit;
  for (int iteration = 0; iteration <= kIterations; ++iteration) {
    const Eigen::VectorXd weight = expected.cwiseProduct(relative).cwiseInverse();
    fit = non_negative_fit(weight.asDiagonal() * a, weight.cwiseProduct(variance));
    if (fit.columns.empty())
      return config::bad_input("no non-negative N, B, K, Q fit this Allan deviation");
    expected = a(Eigen::all, fit.columns) * fit.values;
  }
  // Estimates an octave apart share half of their differences: correlation 2^-octaves.
  const Eigen::VectorXd error = expected.cwiseProduct(relative);
  Eigen::MatrixXd covariance(rows, rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (Eigen::Index j = 0; j < rows; ++j) {
      covariance(i, j) = error[i] * error[j] * std::exp2(-std::abs(log_tau[i] - log_tau[j]));
    }
  }
  const Eigen::MatrixXd chosen = error.cwiseInverse().asDiagonal() * a(Eigen::all, fit.columns);
  const Eigen::VectorXd scale = chosen.colwise().norm().cwiseInverse();
  const Eigen::MatrixXd solve =
      scale.asDiagonal() *
      (chosen * scale.asDiagonal()).completeOrthogonalDecomposition().pseudoInverse() *
      error.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd of_squares = solve * covariance * solve.transpose();

  double values[kCoefficients] = {0.0, 0.0, 0.0, 0.0};
  double errors[kCoefficients];
  std::fill(std::begin(errors), std::end(errors), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < fit.columns.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const auto c = static_cast<std::size_t>(fit.columns[i]);
    values[c] = std::sqrt(fit.values[k]);
    errors[c] = std::sqrt(of_squares(k, k)) / (2.0 * values[c]);  // of the square, halved
  }
  return AllanFit{.noise = {values[0], values[1], values[2], values[3]},
                  .standard_error = {errors[0], errors[1], errors[2], errors[3]}};
}

}  // namespace fogbench::model
