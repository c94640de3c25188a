#include "model/fit/inner_search.hpp"

#include <ceres/ceres.h>
#include <fmt/format.h>
#include <glog/logging.h>

#include <cmath>
#include <limits>
#include <mutex>
#include <span>

namespace fogbench::model {
namespace {

/// A search may leave the typical range by this factor before it is stopped, and only where it
/// gains more of chi squared than noise does by one parameter in 19 of 20 cases.
constexpr double kBeyondRange = 10.0;
constexpr double kWorthLeaving = 3.84;
/// Up to this many rows times parameters, several strategies are tried and the best one is kept.
constexpr std::size_t kFewEnoughForAll = 10'000;

std::optional<LinearFit> fit_at(const Observations& observations, const Eigen::VectorXd& inner,
                                bool with_tangents) {
  const std::optional<Eigen::MatrixXd> triangle = observations.triangle(inner, with_tangents);
  if (!triangle) return {};
  const auto p = static_cast<Eigen::Index>(observations.design().free_columns().size());
  const std::vector<Tangent> tangents =
      with_tangents ? observations.design().tangents() : std::vector<Tangent>{};
  LinearFit fit = fit_triangle(*triangle, p, tangents, inner.size());
  if (!fit.joint.allFinite()) return {};
  return fit;
}

double cost_at(const Observations& observations, const Eigen::VectorXd& inner) {
  const std::optional<LinearFit> fit = fit_at(observations, inner, false);
  return fit ? fit->residual_sum_of_squares : std::numeric_limits<double>::infinity();
}

class ProjectedResidual final : public ceres::CostFunction {
 public:
  ProjectedResidual(const Observations& observations, int parameters)
      : observations_(observations), parameters_(parameters) {
    set_num_residuals(parameters + 1);
    mutable_parameter_block_sizes()->push_back(parameters);
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const bool derivative = jacobians != nullptr && jacobians[0] != nullptr;
    const Eigen::VectorXd inner = Eigen::VectorXd::Map(parameters[0], parameters_);
    const std::optional<LinearFit> fit = fit_at(observations_, inner, derivative);
    if (!fit) return false;
    Eigen::Map<Eigen::VectorXd> r(residuals, parameters_ + 1);
    const Eigen::Index kept = static_cast<Eigen::Index>(fit->kept.size());
    if (!derivative) {
      r.setZero();
      r[0] = std::sqrt(fit->residual_sum_of_squares);
      return true;
    }
    r = fit->joint.col(kept + parameters_).tail(parameters_ + 1);
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> j(
        jacobians[0], parameters_ + 1, parameters_);
    j = -fit->joint.block(kept, kept, parameters_ + 1, parameters_);
    return true;
  }

 private:
  const Observations& observations_;
  int parameters_;
};

/// A residual below this share of the observable's sum of squares is rounding.
constexpr double kExact = 1e-26;
/// So many attempts that end in the same minimum, and none in a better one, are enough.
constexpr int kAgreement = 3;
/// Costs that differ by less than this share are those of one minimum.
constexpr double kSameMinimum = 1e-9;

struct Strategy {
  ceres::TrustRegionStrategyType trust_region;
  ceres::DoglegType dogleg;
  bool jacobi_scaling;
  double initial_radius;
};

constexpr Strategy kStrategies[] = {
    {ceres::LEVENBERG_MARQUARDT, ceres::TRADITIONAL_DOGLEG, true, 1e4},
    {ceres::LEVENBERG_MARQUARDT, ceres::TRADITIONAL_DOGLEG, true, 1e-1},
    {ceres::LEVENBERG_MARQUARDT, ceres::TRADITIONAL_DOGLEG, false, 1e2},
    {ceres::DOGLEG, ceres::SUBSPACE_DOGLEG, true, 1e4},
    {ceres::DOGLEG, ceres::TRADITIONAL_DOGLEG, true, 1.0},
};

/// The least and greatest value that a search may reach.
std::pair<double, double> bounds(const DesignParameter& parameter, double beyond) {
  if (!parameter.range) return {-HUGE_VAL, HUGE_VAL};
  if (!parameter.range->logarithmic) return {parameter.range->minimum, parameter.range->maximum};
  return {parameter.range->minimum / beyond, parameter.range->maximum * beyond};
}

bool within(const Observations& observations, const Eigen::VectorXd& inner, double beyond) {
  for (Eigen::Index i = 0; i < inner.size(); ++i) {
    const auto [least, most] =
        bounds(observations.design().parameters()[static_cast<std::size_t>(i)], beyond);
    if (!(inner[i] >= least && inner[i] <= most)) return false;
  }
  return true;
}

Eigen::VectorXd descend(const Observations& observations, Eigen::VectorXd inner,
                        const Strategy& strategy, double beyond) {
  const int count = static_cast<int>(inner.size());
  ceres::Problem problem;
  problem.AddParameterBlock(inner.data(), count);
  bool bounded = false;
  for (int i = 0; i < count; ++i) {
    const auto [least, most] =
        bounds(observations.design().parameters()[static_cast<std::size_t>(i)], beyond);
    if (!(most > least) || !std::isfinite(least)) continue;
    inner[i] = std::clamp(inner[i], least, most);
    problem.SetParameterLowerBound(inner.data(), i, least);
    problem.SetParameterUpperBound(inner.data(), i, most);
    bounded = true;
  }
  problem.AddResidualBlock(new ProjectedResidual(observations, count), nullptr, inner.data());
  ceres::Solver::Options options;
  // Ceres bounds its steps only under Levenberg-Marquardt.
  options.trust_region_strategy_type = bounded ? ceres::LEVENBERG_MARQUARDT : strategy.trust_region;
  options.dogleg_type = strategy.dogleg;
  options.jacobi_scaling = strategy.jacobi_scaling;
  options.initial_trust_region_radius = strategy.initial_radius;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 1000;
  options.max_num_consecutive_invalid_steps = 50;
  options.function_tolerance = 1e-14;
  options.gradient_tolerance = 1e-30;
  options.parameter_tolerance = 1e-14;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return inner;
}

/// Gauss-Newton steps, for the last digits that a trust region's stopping rules leave.
Eigen::VectorXd polish(const Observations& observations, Eigen::VectorXd inner, double beyond) {
  const Eigen::Index q = inner.size();
  std::optional<LinearFit> fit = fit_at(observations, inner, true);
  for (int step = 0; fit && step < 20; ++step) {
    const auto kept = static_cast<Eigen::Index>(fit->kept.size());
    const Eigen::MatrixXd r = fit->joint.block(kept, kept, q, q);
    if (static_cast<Eigen::Index>(independent_columns(r, q).size()) < q) break;
    const Eigen::VectorXd move =
        r.triangularView<Eigen::Upper>().solve(fit->joint.col(kept + q).segment(kept, q));
    const Eigen::VectorXd next = inner + move;
    if (!within(observations, next, beyond)) break;
    std::optional<LinearFit> better = fit_at(observations, next, true);
    if (!better || !(better->residual_sum_of_squares <= fit->residual_sum_of_squares)) break;
    const bool arrived = (move.array().abs() <= 1e-14 * inner.array().abs()).all();
    inner = next;
    fit = std::move(better);
    if (arrived) break;
  }
  return inner;
}

Eigen::VectorXd descended(const Observations& observations, const Eigen::VectorXd& from,
                          const Strategy& strategy, double beyond) {
  return polish(observations, descend(observations, from, strategy, beyond), beyond);
}

/// Within the typical ranges, unless a given value lies beyond them.
double range_to_search(const Observations& observations, const Eigen::VectorXd& start) {
  return within(observations, start, 1.0) ? 1.0 : kBeyondRange;
}

/// From a solution within the typical ranges to one beyond them, where that pays.
Eigen::VectorXd beyond_where_it_pays(const Observations& observations, Eigen::VectorXd inside) {
  constexpr double kNotAtAnEdge = 0.999;
  if (within(observations, inside, kNotAtAnEdge)) return inside;
  const Eigen::VectorXd outside = descended(observations, inside, kStrategies[0], kBeyondRange);
  const double pays = std::exp(-kWorthLeaving / static_cast<double>(observations.taken().size()));
  const bool leaves = cost_at(observations, outside) < pays * cost_at(observations, inside);
  return leaves ? outside : inside;
}

double grid_point(const InnerParameter& range, int i, int points) {
  const double part = static_cast<double>(i) / (points - 1);
  if (range.logarithmic) {
    return range.minimum * std::pow(range.maximum / range.minimum, part);
  }
  return range.minimum + part * (range.maximum - range.minimum);
}

/// Sets inner[i] to the best of a grid over its range, then of two finer ones about the best.
void search_grid(const Observations& observations, Eigen::VectorXd& inner, Eigen::Index i) {
  InnerParameter range = *observations.design().parameters()[static_cast<std::size_t>(i)].range;
  const InnerParameter whole = range;
  for (const int points : {40, 13, 13}) {
    if (!(range.maximum > range.minimum)) return;
    double best = std::numeric_limits<double>::infinity();
    int best_point = 0;
    Eigen::VectorXd trial = inner;
    for (int point = 0; point < points; ++point) {
      trial[i] = grid_point(range, point, points);
      const double cost = cost_at(observations, trial);
      if (cost < best) {
        best = cost;
        best_point = point;
      }
    }
    inner[i] = grid_point(range, best_point, points);
    const InnerParameter coarse = range;
    range.minimum = std::max(grid_point(coarse, best_point - 1, points), whole.minimum);
    range.maximum = std::min(grid_point(coarse, best_point + 1, points), whole.maximum);
  }
}

Result<InnerSolution> solution_at(const Observations& observations, Eigen::VectorXd inner) {
  std::optional<LinearFit> fit = fit_at(observations, inner, true);
  if (fit) return InnerSolution{std::move(inner), std::move(*fit)};
  return not_finite_at(observations, inner);
}

void silence_ceres() {
  static std::once_flag once;
  std::call_once(once, [] { FLAGS_minloglevel = google::GLOG_FATAL; });
}

}  // namespace

std::optional<LinearFit> linear_fit_at(const Observations& observations,
                                       const Eigen::VectorXd& inner) {
  return fit_at(observations, inner, false);
}

Error not_finite_at(const Observations& observations, const Eigen::VectorXd& inner) {
  const auto bad = observations.not_finite(inner);
  return {ErrorCode::kBadInput,
          bad ? fmt::format("term {}: is not a finite number in row {} of the data at the "
                            "starting values of its parameters",
                            observations.design().term_name(bad->first), bad->second + 1)
              : "the model has no finite derivative by its parameters at their starting values"};
}

Result<InnerSolution> refine_inner(const Observations& observations, const Eigen::VectorXd& start) {
  if (start.size() == 0) return solution_at(observations, start);
  silence_ceres();
  const double beyond = range_to_search(observations, start);
  return solution_at(
      observations,
      beyond_where_it_pays(observations, descended(observations, start, kStrategies[0], beyond)));
}

Result<InnerSolution> search_inner(const Observations& observations) {
  const std::vector<DesignParameter>& parameters = observations.design().parameters();
  const auto count = static_cast<Eigen::Index>(parameters.size());
  Eigen::VectorXd inner(count);
  std::vector<Eigen::Index> unknown;
  for (Eigen::Index i = 0; i < count; ++i) {
    const DesignParameter& parameter = parameters[static_cast<std::size_t>(i)];
    inner[i] = parameter.start ? *parameter.start : grid_point(*parameter.range, 1, 3);
    if (!parameter.start) unknown.push_back(i);
  }
  // Several unknown ones: each in turn, twice, as the best of one depends on the others.
  for (std::size_t pass = 0; pass < (unknown.size() > 1 ? 2 : 1); ++pass) {
    for (const Eigen::Index i : unknown) search_grid(observations, inner, i);
  }
  Result<InnerSolution> start = solution_at(observations, inner);
  if (!start || count == 0) return start;
  silence_ceres();
  Eigen::VectorXd best = inner;
  double least = start->fit.residual_sum_of_squares;
  const auto y = start->fit.joint.cols() - 1;
  const double exact = kExact * start->fit.joint.col(y).squaredNorm();
  int agreed = 0;
  const double beyond = range_to_search(observations, inner);
  const auto attempt = [&](const Eigen::VectorXd& from, const Strategy& strategy) {
    if (least <= exact || agreed >= kAgreement) return;
    const Eigen::VectorXd found = descended(observations, from, strategy, beyond);
    const double cost = cost_at(observations, found);
    if (std::abs(cost - least) <= kSameMinimum * least) ++agreed;
    if (!(cost < least * (1.0 - kSameMinimum))) return;
    agreed = 1;
    least = cost;
    best = found;
  };
  const auto conclude = [&] {
    return solution_at(observations, beyond_where_it_pays(observations, best));
  };
  attempt(inner, kStrategies[0]);
  if (observations.taken().size() * parameters.size() > kFewEnoughForAll) return conclude();
  // Small problems: starts about the given one and every strategy, as a descent may end in a poorer
  // minimum or on a plain.
  for (const double factor : {0.5, 2.0}) attempt(factor * inner, kStrategies[0]);
  for (const Strategy& strategy : std::span(kStrategies).subspan(1)) attempt(inner, strategy);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (const double factor : {0.5, 2.0}) {
      Eigen::VectorXd moved = inner;
      moved[i] *= factor;
      attempt(moved, kStrategies[0]);
    }
  }
  return conclude();
}

}  // namespace fogbench::model
