#include "model/compare/region_noise.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "model/fit/predict.hpp"

namespace fogbench::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kWorlds = 9999;
constexpr std::uint64_t kFloorSeed = 20260102;
// With many rows the plausible noise models are few and alike; those below this weight are not
// worth a pass over the rows.
constexpr double kLeastWeight = 0.01;
// Above this the residual's own size is as good as known.
constexpr double kManyDegrees = 1000.0;
constexpr Index kMostScored = 1000;
constexpr double kInfinite = std::numeric_limits<double>::infinity();

std::vector<std::string> free_names(const FitResult& fit) {
  std::vector<std::string> names;
  for (const Estimate& estimate : fit.estimates) {
    if (!estimate.held) names.push_back(estimate.name);
  }
  return names;
}

/// The number in a model that an estimate's name stands for, moved by a step; the step itself.
double move(config::ModelFile& model, const std::string& name) {
  const std::size_t dot = name.find('.');
  const std::string effect = name.substr(0, dot);
  const std::string key = dot == std::string::npos ? "" : name.substr(dot + 1);
  const auto step_of = [](double value) { return value != 0.0 ? 1e-4 * std::abs(value) : 1e-4; };
  for (config::ModelTerm& term : model.terms) {
    if (term.effect == name && term.coefficient) {
      *term.coefficient += 1.0;
      return 1.0;
    }
    if (term.effect == effect && term.coefficients.contains(key)) {
      term.coefficients[key] += 1.0;
      return 1.0;
    }
  }
  double step = 0.0;  // expression terms share their parameters: move all of that name
  for (config::ModelTerm& term : model.terms) {
    const std::string& wanted = term.expression && key.empty() ? name : key;
    if ((term.effect != effect && !term.expression) || !term.parameters.contains(wanted)) continue;
    double& value = term.parameters[wanted];
    step = step_of(value);
    value += step;
  }
  return step;
}

/// Which of the estimates that are not held were determined.
std::vector<Index> determined(const FitResult& fit) {
  std::vector<Index> out;
  for (Index k = 0; k < fit.covariance.rows(); ++k) {
    if (std::isfinite(fit.covariance(k, k))) out.push_back(k);
  }
  return out;
}

}  // namespace

Result<VectorXd> tangent(const Table& table, const FitResult& fit, Index column) {
  const auto count = static_cast<Index>(fit.rows.size());
  config::ModelFile moved = fit.fitted;
  const double step = move(moved, free_names(fit)[static_cast<std::size_t>(column)]);
  if (step == 0.0) return VectorXd(VectorXd::Zero(count));
  const auto values = predict(table, moved);
  if (!values) return values.error();
  VectorXd out(count);
  for (Index i = 0; i < count; ++i) {
    const auto row = static_cast<Index>(fit.rows[static_cast<std::size_t>(i)]);
    out[i] = ((*values)[row] - fit.predicted[i]) / step;
  }
  return out;
}

Result<RegionNoise> RegionNoise::make(const Table& table, const FitOptions& options,
                                      const FitResult& fit,
                                      const std::vector<Partition>& partitions) {
  RegionNoise out;
  const bool project = !options.as_is;
  out.held_ = options.as_is;
  out.degrees_ = kInfinite;
  if (fit.coloured) {
    const Status done = out.coloured(table, options, fit, partitions);
    if (!done) return done.error();
    return out;
  }
  VectorXd deviation = fit.standard_deviation;
  out.says_ = fit.noise.says;
  out.degrees_ = fit.degrees_of_freedom;
  if (options.as_is) {
    const char* stated[] = {options.weight_by.c_str(), "rate_std_error_deg_per_h",
                            "sigma_deg_per_h"};
    for (const char* column : stated) {
      if (*column == '\0' || !table.has(column)) continue;
      const std::span<const double> values = table.column(column);
      VectorXd of_rows(fit.residual.size());
      for (std::size_t i = 0; i < fit.rows.size(); ++i) {
        of_rows[static_cast<Index>(i)] = values[fit.rows[i]];
      }
      if (!of_rows.allFinite() || of_rows.minCoeff() <= 0.0) continue;
      deviation = of_rows;
      out.degrees_ = kInfinite;
      out.says_ = fmt::format("independent, as the column {} states it", column);
      break;
    }
  }
  const bool from_fit = out.degrees_ < kInfinite;
  if (options.as_is && from_fit) {
    // The free terms' residual; without rows to spare there was no such fit.
    out.degrees_ = fit.degrees_of_freedom - static_cast<double>(fit.estimates.size());
  }
  if (!(out.degrees_ > 0.0) || deviation.size() != fit.residual.size() || !deviation.allFinite() ||
      deviation.size() == 0 || deviation.minCoeff() <= 0.0) {
    out.says_ = "unknown: the table states none and no fit leaves a residual to take it from";
    return out;
  }
  const Status done = out.independent(table, fit, partitions, deviation, project);
  if (!done) return done.error();
  return out;
}

Status RegionNoise::coloured(const Table& table, const FitOptions& options, const FitResult& fit,
                             const std::vector<Partition>& partitions) {
  auto shapes = NoiseShapes::make(fit.windows, options.prior);
  if (!shapes) return shapes.error();
  const Index n = fit.windows.rows();
  set_counts(partitions);
  MatrixXd weights = MatrixXd::Zero(n, counts_.size());
  Index first = 0;
  for (const Partition& partition : partitions) {
    for (std::size_t i = 0; i < partition.index.size(); ++i) {
      if (partition.index[i] < 0) continue;
      const Index g = first + partition.index[i];
      weights(fit.window_of[i], g) += 1.0 / counts_[g];
    }
    first += static_cast<Index>(partition.ranges.size());
  }
  const std::vector<Index> columns = held_ ? std::vector<Index>{} : determined(fit);
  MatrixXd x = MatrixXd::Zero(n, static_cast<Index>(columns.size()));
  VectorXd members = VectorXd::Zero(n);
  for (Index window : fit.window_of) members[window] += 1.0;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const auto values = tangent(table, fit, columns[k]);
    if (!values) return values.error();
    for (std::size_t i = 0; i < fit.window_of.size(); ++i) {
      const Index window = fit.window_of[i];
      x(window, static_cast<Index>(k)) += (*values)[static_cast<Index>(i)] / members[window];
    }
  }
  covariance_ = MatrixXd::Zero(counts_.size(), counts_.size());
  double total = 0.0;
  for (const auto& [noise, weight] : fit.noise.plausible) {
    if (weight < kLeastWeight) continue;
    const auto whitener = shapes->whitener(noise);
    const MatrixXd spread = whitener->colour_transposed(weights);
    covariance_ += weight * spread.transpose() * spread;
    if (x.cols() > 0) {
      const Eigen::ColPivHouseholderQR<MatrixXd> qr(whitener->whiten(x));
      const MatrixXd q = qr.householderQ() * MatrixXd::Identity(n, qr.rank());
      const MatrixXd fitted = q.transpose() * spread;
      covariance_ -= weight * fitted.transpose() * fitted;
    }
    total += weight;
  }
  if (total == 0.0) return Error{ErrorCode::kBadInput, "the fit has no plausible noise model"};
  covariance_ /= total;
  floor_ = noise_floor(*shapes, fit.noise, x, n, kFloorSeed);
  const double white = fit.noise.noise.angle_random_walk_deg_per_sqrt_h;
  const double more = white * white * fit.white_beside_windows;
  for (double* rms : {&floor_.white, &floor_.median, &floor_.low, &floor_.high}) {
    *rms = std::sqrt(*rms * *rms + more);
  }
  says_ = fit.noise.says;
  known_ = true;
  // A held model's miss must not be weighed against noise that may explain it anew.
  if (n > kMostScored || held_) return {};
  shapes_ = std::move(*shapes);
  fitted_columns_ = std::move(x);
  indicators_ = weights * counts_.asDiagonal();
  window_residual_ = VectorXd::Zero(n);
  for (std::size_t i = 0; i < fit.window_of.size(); ++i) {
    window_residual_[fit.window_of[i]] +=
        fit.residual[static_cast<Index>(i)] / members[fit.window_of[i]];
  }
  return {};
}

Status RegionNoise::independent(const Table& table, const FitResult& fit,
                                const std::vector<Partition>& partitions, const VectorXd& deviation,
                                bool project) {
  set_counts(partitions);
  const Index regions = counts_.size();
  covariance_ = MatrixXd::Zero(regions, regions);
  std::vector<Index> member(partitions.size());
  for (Index i = 0; i < deviation.size(); ++i) {
    Index first = 0;
    for (std::size_t p = 0; p < partitions.size(); ++p) {
      const std::int16_t range = partitions[p].index[static_cast<std::size_t>(i)];
      member[p] = range < 0 ? -1 : first + range;
      first += static_cast<Index>(partitions[p].ranges.size());
    }
    const double variance = deviation[i] * deviation[i];
    for (std::size_t p = 0; p < member.size(); ++p) {
      for (std::size_t q = 0; q <= p && member[p] >= 0; ++q) {
        if (member[q] >= 0) covariance_(member[p], member[q]) += variance;
      }
    }
  }
  const VectorXd inverse = counts_.cwiseMax(1.0).cwiseInverse();
  covariance_ = inverse.asDiagonal() * MatrixXd(covariance_.selfadjointView<Eigen::Lower>()) *
                inverse.asDiagonal();
  const double rms = std::sqrt(deviation.squaredNorm() / static_cast<double>(deviation.size()));
  floor_ = {rms, rms, rms, rms};
  known_ = true;
  if (!project) return {};

  const std::vector<Index> columns = determined(fit);
  MatrixXd means = MatrixXd::Zero(regions, static_cast<Index>(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const auto values = tangent(table, fit, columns[k]);
    if (!values) return values.error();
    Index first = 0;
    for (const Partition& partition : partitions) {
      for (std::size_t i = 0; i < partition.index.size(); ++i) {
        if (partition.index[i] < 0) continue;
        means(first + partition.index[i], static_cast<Index>(k)) +=
            (*values)[static_cast<Index>(i)];
      }
      first += static_cast<Index>(partition.ranges.size());
    }
  }
  means = inverse.asDiagonal() * means;
  covariance_ -= means * fit.covariance(columns, columns) * means.transpose();
  return {};
}

void RegionNoise::set_counts(const std::vector<Partition>& partitions) {
  std::vector<double> counts;
  for (const Partition& partition : partitions) {
    const std::size_t first = counts.size();
    counts.resize(first + partition.ranges.size(), 0.0);
    for (std::int16_t range : partition.index) {
      if (range >= 0) counts[first + static_cast<std::size_t>(range)] += 1.0;
    }
  }
  counts_ = Eigen::Map<const VectorXd>(counts.data(), static_cast<Index>(counts.size()));
}

VectorXd RegionNoise::standard_errors() const {
  VectorXd out = covariance_.diagonal().cwiseMax(0.0).cwiseSqrt();
  // What the fit leaves no freedom is zero but for rounding.
  const double least = 1e-6 * floor_.white;
  for (Index g = 0; g < out.size(); ++g) {
    if (out[g] * std::sqrt(std::max(counts_[g], 1.0)) < least) out[g] = 0.0;
  }
  return out;
}

RegionScores RegionNoise::scores(const VectorXd& mean_residual, std::uint64_t seed) const {
  if (shapes_ && indicators_.cols() > 0) {
    return score_regions(*shapes_, fitted_columns_, window_residual_, indicators_, seed);
  }
  const VectorXd error = standard_errors();
  RegionScores out{.offset = {}, .z = VectorXd::Zero(error.size()), .family_wise = {}};
  for (Index g = 0; g < error.size(); ++g) {
    if (error[g] > 0.0) out.z[g] = mean_residual[g] / error[g];
  }
  out.family_wise = family_wise(out.z.cwiseAbs(), seed);
  return out;
}

VectorXd RegionNoise::family_wise(const VectorXd& z, std::uint64_t seed) const {
  if (z.size() == 0) return {};
  const VectorXd error = standard_errors();
  const VectorXd scale = error.unaryExpr([](double e) { return e > 0.0 ? 1.0 / e : 0.0; });
  const MatrixXd correlation = scale.asDiagonal() * covariance_ * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(correlation);
  std::vector<Index> kept;
  for (Index i = 0; i < correlation.rows(); ++i) {
    if (eigen.eigenvalues()[i] > 1e-9) kept.push_back(i);
  }
  MatrixXd factor = eigen.eigenvectors()(Eigen::all, kept);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    factor.col(static_cast<Index>(i)) *= std::sqrt(eigen.eigenvalues()[kept[i]]);
  }
  // With a size taken from the residual, only the residual's direction is random: a point on the
  // sphere of as many dimensions as there are degrees of freedom, of which the regions see some.
  // A held model's residual is not the one that the size came from: there the two are independent.
  const bool estimated = degrees_ < kManyDegrees;
  const double seen = held_ ? 0.0 : static_cast<double>(kept.size());
  const double unseen = estimated ? degrees_ - seen : 0.0;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::chi_squared_distribution<double> rest(std::max(unseen, 1.0));
  std::vector<double> largest;
  VectorXd draw(static_cast<Index>(kept.size()));
  for (int i = 0; i < kWorlds; ++i) {
    for (double& value : draw) value = normal(random);
    double size = 1.0;
    if (estimated) {
      const double squares =
          (held_ ? 0.0 : draw.squaredNorm()) + (unseen > 0.5 ? rest(random) : 0.0);
      size = std::sqrt(squares / degrees_);
    }
    largest.push_back(draw.size() == 0 ? 0.0 : (factor * draw).cwiseAbs().maxCoeff() / size);
  }
  std::sort(largest.begin(), largest.end());
  const double tested = static_cast<double>((error.array() > 0.0).count());
  VectorXd out = VectorXd::Ones(z.size());
  for (Index g = 0; g < z.size(); ++g) {
    const double value = z[g];
    if (value == 0.0) continue;
    const auto at_least = static_cast<double>(
        largest.end() - std::lower_bound(largest.begin(), largest.end(), value * (1.0 - 1e-9)));
    double p = (1.0 + at_least) / (1.0 + kWorlds);
    if (at_least == 0.0) {  // beyond the draws: Bonferroni's bound
      if (!estimated) p = std::min(p, tested * std::erfc(value / std::numbers::sqrt2));
    }
    out[g] = p;
  }
  return out;
}

}  // namespace fogbench::model
