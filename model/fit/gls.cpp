#include "model/fit/gls.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "model/fit/reduction.hpp"
#include "model/noise/shape_grid.hpp"
#include "model/noise/window_geometry.hpp"

namespace fogbench::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kLeastShapeWeight = 1e-4;
// Below this nothing could be told about the shape of noise whose size is unknown as well.
constexpr double kFewestRowsForNoise = 10.0;
constexpr double kRankThreshold = 1e-10;
// deg/sqrt(h): far below any gyro and above the rounding of its numbers; keeps a perfect fit
// finite.
constexpr double kLeastWhite = 1e-12;
// Twice the log-likelihood that a coefficient must win to be called distinguishable from zero
// (5 % one-sided, chi-squared with one degree of freedom and the zero on the boundary).
constexpr double kDistinguishable = 2.71;
// Of the table of log P(nu/2, x): from e^-4 to e^4 times its median.
constexpr double kTableSpan = 4.0;
constexpr double kTableStep = 0.005;

/// log of the regularised lower incomplete gamma function; the value itself may underflow.
double log_gamma_p(double a, double x) {
  if (x > a) return std::log(boost::math::gamma_p(a, x));
  double term = 1.0, sum = 1.0;
  for (int n = 1; n < 10000 && term > 1e-17 * sum; ++n) {
    term *= x / (a + n);
    sum += term;
  }
  return a * std::log(x) - x - std::lgamma(a + 1.0) + std::log(sum);
}

/// One shape's part of the answer.
struct Solution {
  MatrixXd r;  // triangle of the whitened [X y]
  double residual_squares = 0.0;
  double log_weight = 0.0;  // marginal over N; without the prior of the shape
};

class Problem {
 public:
  Problem(const NoiseShapes& shapes, const MatrixXd& x, const VectorXd& y)
      : kept_(independent_columns(x, x.cols(), kRankThreshold)) {
    joined_.resize(x.rows(), static_cast<Index>(kept_.size()) + 1);
    for (std::size_t i = 0; i < kept_.size(); ++i) {
      joined_.col(static_cast<Index>(i)) = x.col(kept_[i]);
    }
    joined_.rightCols(1) = y;
    nu_ = static_cast<double>(x.rows() - rank());
    anchor_ = std::max(shapes.anchor(), 0.0);
  }

  Index rank() const { return static_cast<Index>(kept_.size()); }
  double nu() const { return nu_; }
  const std::vector<Index>& kept() const { return kept_; }

  Solution solve(const Whitener& whitener) const {
    const MatrixXd whitened = whitener.whiten(joined_);
    Solution s;
    s.r = Eigen::HouseholderQR<MatrixXd>(whitened).matrixQR().topRows(rank() + 1);
    const double left = s.r(rank(), rank());
    const double rounding = 1e-15 * whitened.rightCols(1).norm();
    s.residual_squares = left * left + rounding * rounding + nu_ * kLeastWhite * kLeastWhite;
    s.log_weight = -0.5 * whitener.log_determinant() - log_determinant_of_x(s) -
                   0.5 * nu_ * std::log(s.residual_squares);
    if (anchor_ > 0.0) s.log_weight += log_gamma_p(0.5 * nu_, anchored_half_chi2(s));
    return s;
  }

  /// Posterior mean of N^2 given the shape.
  double mean_white_squared(const Solution& s) const {
    if (nu_ <= 3.0) return best_white_squared(s);
    const double free = s.residual_squares / (nu_ - 2.0);
    if (anchor_ == 0.0) return free;
    const double x = anchored_half_chi2(s);
    return free * std::exp(log_gamma_p(0.5 * nu_ - 1.0, x) - log_gamma_p(0.5 * nu_, x));
  }

  double best_white_squared(const Solution& s) const {
    return std::max(anchor_ * anchor_, s.residual_squares / nu_);
  }

  double log_likelihood(const Solution& s, const Whitener& whitener) const {
    const double n2 = best_white_squared(s);
    return -0.5 * (nu_ * std::log(2.0 * std::numbers::pi * n2) + whitener.log_determinant() +
                   s.residual_squares / n2) -
           log_determinant_of_x(s);
  }

  VectorXd beta(const Solution& s) const {
    return s.r.topLeftCorner(rank(), rank())
        .triangularView<Eigen::Upper>()
        .solve(s.r.col(rank()).head(rank()));
  }

  MatrixXd unscaled_covariance(const Solution& s) const {
    const MatrixXd inverse = s.r.topLeftCorner(rank(), rank())
                                 .triangularView<Eigen::Upper>()
                                 .solve(MatrixXd::Identity(rank(), rank()));
    return inverse * inverse.transpose();
  }

 private:
  double anchored_half_chi2(const Solution& s) const {
    return 0.5 * s.residual_squares / (anchor_ * anchor_);
  }
  double log_determinant_of_x(const Solution& s) const {
    return s.r.diagonal().head(rank()).array().abs().log().sum();
  }

  std::vector<Index> kept_;
  MatrixXd joined_;
  double nu_ = 0.0;
  double anchor_ = 0.0;
};

/// Climbs from the best shape of the grid with a shrinking cross of trial points in the logarithms
/// of B/N and K/N. A coefficient that is zero there stays zero.
NoiseCoefficients refine(const NoiseShapes& shapes, const ShapeGrid& grid, const Problem& problem,
                         NoiseCoefficients best, double best_weight) {
  double step_b = grid.step_of_b() / 2.0;
  double step_k = grid.step_of_k() / 2.0;
  constexpr int kHalvings = 4;
  for (int level = 0; level < kHalvings; ++level, step_b /= 2.0, step_k /= 2.0) {
    const NoiseCoefficients centre = best;
    for (const auto& [b, k] :
         {std::pair{step_b, 0.0}, {-step_b, 0.0}, {0.0, step_k}, {0.0, -step_k}}) {
      NoiseCoefficients trial = centre;
      trial.bias_instability_deg_per_h *= std::exp(b);
      trial.rate_random_walk_deg_per_h_per_sqrt_h *= std::exp(k);
      const bool same = b != 0.0 ? trial.bias_instability_deg_per_h == 0.0
                                 : trial.rate_random_walk_deg_per_h_per_sqrt_h == 0.0;
      if (same) continue;
      if (trial.bias_instability_deg_per_h > shapes.prior().b_over_n.most() ||
          trial.rate_random_walk_deg_per_h_per_sqrt_h > shapes.prior().k_over_n.most()) {
        continue;
      }
      const double weight =
          problem.solve(*shapes.whitener(trial)).log_weight + grid.log_prior(trial);
      if (weight > best_weight) {
        best = trial;
        best_weight = weight;
      }
    }
  }
  return best;
}

NoiseCoefficients scaled(NoiseCoefficients shape, double white) {
  shape.angle_random_walk_deg_per_sqrt_h *= white;
  shape.bias_instability_deg_per_h *= white;
  shape.rate_random_walk_deg_per_h_per_sqrt_h *= white;
  return shape;
}

std::string describe(const NoiseEstimate& estimate, bool too_few, double nu, double without_b,
                     double without_k) {
  const NoiseCoefficients& noise = estimate.noise;
  std::string text =
      fmt::format("white N = {:.3g} deg/sqrt(h) ({})", noise.angle_random_walk_deg_per_sqrt_h,
                  estimate.anchored ? "bounded below by the stated standard errors"
                                    : "from the residual alone");
  if (too_few) {
    return text + fmt::format(
                      "; flicker and rate random walk cannot be told from {:.0f} degrees "
                      "of freedom, the noise is taken as white",
                      nu);
  }
  const auto add = [&](const char* name, double value, const char* unit, double gain) {
    text += gain > kDistinguishable ? fmt::format(", {} = {:.3g} {}", name, value, unit)
                                    : fmt::format(", {} not distinguishable from zero", name);
  };
  add("bias instability B", noise.bias_instability_deg_per_h, "deg/h", without_b);
  add("rate random walk K", noise.rate_random_walk_deg_per_h_per_sqrt_h, "deg/h/sqrt(h)",
      without_k);
  return text;
}

}  // namespace

ResidualEvidence::ResidualEvidence(double nu, double anchor) : nu_(nu), anchor_(anchor) {
  if (anchor_ == 0.0) return;
  // Below the table P is a power of its argument, above it one.
  const double first = std::log(0.5 * nu_) - kTableSpan;
  first_ = first + std::log(2.0 * anchor_ * anchor_);
  const auto steps = static_cast<int>(2.0 * kTableSpan / kTableStep) + 1;
  for (int i = 0; i < steps; ++i) {
    table_.push_back(log_gamma_p(0.5 * nu_, std::exp(first + i * kTableStep)));
  }
}

double ResidualEvidence::log_p(double log_squares) const {
  if (anchor_ == 0.0) return 0.0;
  const double place = (log_squares - first_) / kTableStep;
  if (place >= static_cast<double>(table_.size() - 1)) return 0.0;
  if (place < 0.0) return log_gamma_p(0.5 * nu_, 0.5 * std::exp(log_squares) / (anchor_ * anchor_));
  const auto i = static_cast<std::size_t>(place);
  const double part = place - static_cast<double>(i);
  return (1.0 - part) * table_[i] + part * table_[i + 1];
}

double ResidualEvidence::operator()(double residual_squares) const {
  const double log_squares = std::log(std::max(residual_squares, nu_ * kLeastWhite * kLeastWhite));
  return -0.5 * nu_ * log_squares + log_p(log_squares);
}

void ResidualEvidence::change(double residual_squares, Eigen::Ref<Eigen::ArrayXf> log_ratio) const {
  const double least = std::log(nu_ * kLeastWhite * kLeastWhite);
  const double now = std::max(std::log(residual_squares), least);
  const double p_now = log_p(now);
  for (float& ratio : log_ratio) {
    const double then = std::max(now + static_cast<double>(ratio), least);
    ratio = static_cast<float>(-0.5 * nu_ * (then - now) + log_p(then) - p_now);
  }
}

Result<GlsResult> gls(const NoiseShapes& shapes, const MatrixXd& x, const VectorXd& y) {
  if (x.rows() != shapes.rows() || y.size() != shapes.rows()) {
    return Error{ErrorCode::kBadInput,
                 fmt::format("{} windows, {} rows of regressors and {} measurements: as many of "
                             "each were expected",
                             shapes.rows(), x.rows(), y.size())};
  }
  if (x.rows() <= x.cols()) {
    return Error{ErrorCode::kBadInput,
                 fmt::format("{} rows for {} terms: more rows than terms were expected", x.rows(),
                             x.cols())};
  }
  if (!x.allFinite() || !y.allFinite()) {
    return Error{ErrorCode::kBadInput, "a regressor or a measurement is not a number"};
  }
  const Problem problem(shapes, x, y);
  GlsResult result;
  result.degrees_of_freedom = problem.nu();
  result.noise.anchored = shapes.anchor() > 0.0;
  const bool too_few = !result.noise.anchored && problem.nu() < kFewestRowsForNoise;

  ShapeGrid grid(shapes);
  std::vector<Solution> solutions;
  std::vector<double> likelihood;  // of each shape
  do {
    for (std::size_t i = solutions.size(); i < (too_few ? 1 : grid.size()); ++i) {
      solutions.push_back(problem.solve(*grid.whitener(i)));
      likelihood.push_back(solutions[i].log_weight);
    }
  } while (!too_few && grid.refine({likelihood}));
  std::size_t best = 0;
  double best_without_b = -std::numeric_limits<double>::infinity();
  double best_without_k = best_without_b;
  for (std::size_t i = 0; i < solutions.size(); ++i) {
    solutions[i].log_weight += grid.log_prior(i);
    if (solutions[i].log_weight > solutions[best].log_weight) best = i;
    const NoiseCoefficients& shape = grid.shape(i);
    if (shape.bias_instability_deg_per_h == 0.0) {
      best_without_b = std::max(best_without_b, likelihood[i]);
    }
    if (shape.rate_random_walk_deg_per_h_per_sqrt_h == 0.0) {
      best_without_k = std::max(best_without_k, likelihood[i]);
    }
  }

  const double top = solutions[best].log_weight;
  double total = 0.0;
  for (const Solution& s : solutions) {
    const double weight = std::exp(s.log_weight - top);
    if (weight > kLeastShapeWeight) total += weight;
  }
  const Index rank = problem.rank();
  VectorXd mean = VectorXd::Zero(rank);
  MatrixXd second = MatrixXd::Zero(rank, rank);
  for (std::size_t i = 0; i < solutions.size(); ++i) {
    const double raw = std::exp(solutions[i].log_weight - top);
    if (raw <= kLeastShapeWeight) continue;
    const double weight = raw / total;
    const double white2 = too_few ? problem.best_white_squared(solutions[i])
                                  : problem.mean_white_squared(solutions[i]);
    const VectorXd beta = problem.beta(solutions[i]);
    mean += weight * beta;
    second += weight * white2 * problem.unscaled_covariance(solutions[i]);
    result.noise.plausible.emplace_back(scaled(grid.shape(i), std::sqrt(white2)), weight);
  }
  for (std::size_t i = 0; i < solutions.size(); ++i) {
    const double raw = std::exp(solutions[i].log_weight - top);
    if (raw <= kLeastShapeWeight) continue;
    const VectorXd off = problem.beta(solutions[i]) - mean;
    second += raw / total * off * off.transpose();
  }

  result.beta = VectorXd::Zero(x.cols());
  result.covariance =
      MatrixXd::Constant(x.cols(), x.cols(), std::numeric_limits<double>::quiet_NaN());
  result.beta(problem.kept()) = mean;
  result.covariance(problem.kept(), problem.kept()) = second;
  result.residual = y - x * result.beta;

  const NoiseCoefficients shape =
      too_few ? shapes.shape(0) : refine(shapes, grid, problem, grid.shape(best), top);
  const auto unit = shapes.whitener(shape);
  const Solution at_best = problem.solve(*unit);
  const double white = std::sqrt(problem.best_white_squared(at_best));
  result.noise.noise = scaled(shape, white);
  result.noise.log_likelihood = problem.log_likelihood(at_best, *unit);
  result.noise.says =
      describe(result.noise, too_few, problem.nu(), 2.0 * (at_best.log_weight - best_without_b),
               2.0 * (at_best.log_weight - best_without_k));
  result.whitened = unit->whiten(result.residual) / white;
  result.standard_deviation = unit->standard_deviation() * white;
  if (too_few) {
    const boost::math::students_t student(problem.nu());
    result.coverage_factor = boost::math::quantile(student, 0.5 + 0.5 * kTwoSigma);
  }
  return result;
}

Result<GlsResult> gls(const Windows& windows, const MatrixXd& x, const VectorXd& y) {
  auto shapes = NoiseShapes::make(windows);
  if (!shapes) return shapes.error();
  return gls(*shapes, x, y);
}

Result<NoiseEstimate> estimate_noise(const Windows& windows, const MatrixXd& x, const VectorXd& y) {
  auto result = gls(windows, x, y);
  if (!result) return result.error();
  return std::move(result->noise);
}

}  // namespace fogbench::model
