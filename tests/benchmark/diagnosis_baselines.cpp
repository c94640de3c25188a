#include "tests/benchmark/diagnosis_baselines.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "model/effects/catalogue.hpp"
#include "model/noise/noise.hpp"
#include "tests/benchmark/candidate_columns.hpp"

namespace fogbench::tests {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Names = std::vector<std::string>;

constexpr std::size_t kMostEffects = 8;
double bic(const CandidateColumns& problem, double squares, double parameters) {
  const auto n = static_cast<double>(problem.y.size());
  return n * std::log(std::max(squares, 1e-300) / n) +
         (parameters + static_cast<double>(problem.base_columns)) * std::log(n);
}

double residual_squares(const MatrixXd& x, const VectorXd& y) {
  if (x.cols() == 0) return y.squaredNorm();
  return (y - x * x.colPivHouseholderQr().solve(y)).squaredNorm();
}

void add_name(Names& names, const std::string& name) {
  if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
}

Names stepwise(const CandidateColumns& problem) {
  Names names;
  MatrixXd taken(problem.y.size(), 0);
  double parameters = 0.0;
  double best = bic(problem, problem.y.squaredNorm(), 0.0);
  while (names.size() < kMostEffects) {
    const CandidateColumns::Group* winner = nullptr;
    MatrixXd with;
    for (const CandidateColumns::Group& group : problem.groups) {
      MatrixXd trial(taken.rows(), taken.cols() + group.width);
      trial << taken, problem.columns.middleCols(group.first, group.width);
      const double value =
          bic(problem, residual_squares(trial, problem.y),
              parameters + static_cast<double>(group.width) + group.inner_parameters);
      if (value >= best) continue;
      best = value;
      winner = &group;
      with = std::move(trial);
    }
    if (winner == nullptr) break;
    parameters += static_cast<double>(winner->width) + winner->inner_parameters;
    taken = std::move(with);
    add_name(names, winner->effect);
  }
  return names;
}

/// The effects of the columns that are used, and their BIC after a plain refit.
struct Selection {
  Names names;
  double bic = std::numeric_limits<double>::infinity();
};

Selection select(const CandidateColumns& problem, const std::vector<Index>& used) {
  if (static_cast<Index>(used.size()) + problem.base_columns + 1 >= problem.y.size()) return {};
  const MatrixXd x = problem.columns(Eigen::all, used);
  Selection out{
      .names = {},
      .bic = bic(problem, residual_squares(x, problem.y), static_cast<double>(used.size()))};
  for (const CandidateColumns::Group& group : problem.groups) {
    for (const Index j : used) {
      if (j >= group.first && j < group.first + group.width) add_name(out.names, group.effect);
    }
  }
  return out;
}

std::vector<Index> not_zero(const VectorXd& beta) {
  std::vector<Index> out;
  for (Index j = 0; j < beta.size(); ++j) {
    if (beta[j] != 0.0) out.push_back(j);
  }
  return out;
}

Names lasso(const CandidateColumns& problem) {
  constexpr int kPenalties = 40, kRounds = 200;
  const VectorXd reach = problem.columns.transpose() * problem.y;
  const double largest = reach.size() > 0 ? reach.cwiseAbs().maxCoeff() : 0.0;
  VectorXd beta = VectorXd::Zero(problem.columns.cols());
  VectorXd left = problem.y;
  Selection best = select(problem, {});
  for (int step = 1; step <= kPenalties; ++step) {
    const double penalty = largest * std::pow(1e-3, static_cast<double>(step) / kPenalties);
    for (int round = 0; round < kRounds; ++round) {
      double moved = 0.0;
      for (Index j = 0; j < beta.size(); ++j) {
        const double pull = beta[j] + problem.columns.col(j).dot(left);
        const double next = std::copysign(std::max(std::abs(pull) - penalty, 0.0), pull);
        if (next == beta[j]) continue;
        left -= (next - beta[j]) * problem.columns.col(j);
        moved = std::max(moved, std::abs(next - beta[j]));
        beta[j] = next;
      }
      if (moved < 1e-4 * largest) break;
    }
    Selection now = select(problem, not_zero(beta));
    if (now.bic < best.bic) best = std::move(now);
  }
  return best.names;
}

Names thresholding(const CandidateColumns& problem) {
  constexpr double kRidge = 0.05;  // as PySINDy's STLSQ has it
  constexpr int kThresholds = 20, kRounds = 20;
  Selection best = select(problem, {});
  const double length = problem.y.norm();
  for (int step = 0; step < kThresholds; ++step) {
    const double least = length * std::pow(1e-2, static_cast<double>(step) / kThresholds);
    std::vector<Index> used;
    for (Index j = 0; j < problem.columns.cols(); ++j) used.push_back(j);
    for (int round = 0; round < kRounds && !used.empty(); ++round) {
      const MatrixXd x = problem.columns(Eigen::all, used);
      MatrixXd normal = x.transpose() * x;
      normal.diagonal().array() += kRidge;
      const VectorXd beta = normal.llt().solve(x.transpose() * problem.y);
      std::vector<Index> kept;
      for (std::size_t i = 0; i < used.size(); ++i) {
        if (std::abs(beta[static_cast<Index>(i)]) >= least) kept.push_back(used[i]);
      }
      if (kept.size() == used.size()) break;
      used = std::move(kept);
    }
    Selection now = select(problem, used);
    if (now.bic < best.bic) best = std::move(now);
  }
  return best.names;
}

/// Whitening with the noise that the base model's residual suggests.
Whitening whitening_under_base(const model::Signals& signals, const config::ModelFile& model) {
  model::Windows windows;
  for (const auto& run : signals.runs()) windows.run_begin.push_back(run.begin);
  windows.run_begin.push_back(signals.rows());
  windows.centre_s = signals.signal("time_s");
  windows.duration_s = signals.signal("duration_s");
  windows.white_floor = VectorXd::Zero(windows.centre_s.size());
  if (signals.available("rate_std_error_deg_per_h")) {
    windows.white_floor = signals.signal("rate_std_error_deg_per_h");
  }
  MatrixXd x(windows.rows(), static_cast<Index>(model.terms.size()));
  for (std::size_t i = 0; i < model.terms.size(); ++i) {
    x.col(static_cast<Index>(i)) =
        model::find_effect(model.terms[i].effect)->regressor(signals, {});
  }
  const auto noise = model::estimate_noise(windows, x, signals.signal(model.observable));
  if (!noise) return [](const MatrixXd& a) { return a; };
  auto whitener = model::make_whitener(windows, noise->noise);
  if (!whitener) return [](const MatrixXd& a) { return a; };
  const std::shared_ptr<const model::Whitener> kept = std::move(*whitener);
  return [kept](const MatrixXd& a) { return kept->whiten(a); };
}

}  // namespace

std::array<Names, kBaselines.size()> baseline_answers(const model::Table& table,
                                                      const config::ModelFile& model) {
  const model::Signals signals(table, model.reference_temperature_c);
  const CandidateColumns plain =
      candidate_columns(signals, model, [](const MatrixXd& a) { return a; });
  const CandidateColumns coloured =
      candidate_columns(signals, model, whitening_under_base(signals, model));
  return {stepwise(plain), stepwise(coloured), lasso(plain), thresholding(plain)};
}

}  // namespace fogbench::tests
