#include "model/diagnose/heldout.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>

#include "model/fit/design.hpp"
#include "model/table/signals.hpp"

namespace fogbench::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kFolds = 8;
// Each fold leaves out this many blocks, far apart: one block that held a whole sweep would ask for
// an extrapolation.
constexpr std::size_t kBlocksPerFold = 3;

// A left-out direction of which the other rows hold less than this share of what is known is not
// predicted by them: a warm-up's first rows.
constexpr double kUnpredictable = 0.1;
// A row of which the others tell less than it does itself is no test of them.
constexpr double kLessThanItself = 1.0;
// Twice a log-likelihood: a part in which a column is next to nothing has no opinion on it.
constexpr double kNoDifference = 0.25;

/// Of the rows that have a measurement.
struct System {
  MatrixXd x;
  VectorXd y;
  Index starts = 0;  ///< the last of the columns: how memories began
};

std::optional<System> system_of(const Signals& signals, config::ModelFile model) {
  for (config::ModelTerm& term : model.terms) {
    if (term.fixed) continue;
    term.coefficient.reset();
    term.coefficients.clear();
  }
  const auto design = Design::make(signals, model, false);
  if (!design) return std::nullopt;
  VectorXd inner(static_cast<Index>(design->parameters().size()));
  for (Index i = 0; i < inner.size(); ++i) {
    inner[i] = design->parameters()[static_cast<std::size_t>(i)].start.value_or(1.0);
  }
  System out;
  for (const Index column : design->free_columns()) {
    out.starts += design->columns()[static_cast<std::size_t>(column)].start ? 1 : 0;
  }
  const auto n = static_cast<Index>(signals.rows());
  design->visit(inner, false, signals.signal(model.observable),
                [&](std::size_t begin, Eigen::Ref<MatrixXd> rows) {
                  if (out.y.size() == 0) {
                    out.x.resize(n, rows.cols() - 1);
                    out.y.resize(n);
                  }
                  const auto at = static_cast<Index>(begin);
                  out.x.middleRows(at, rows.rows()) = rows.leftCols(rows.cols() - 1);
                  out.y.segment(at, rows.rows()) = rows.rightCols(1);
                });
  std::vector<Index> measured;
  for (Index i = 0; i < n; ++i) {
    if (std::isfinite(out.y[i])) measured.push_back(i);
  }
  out.x = out.x(measured, Eigen::all).eval();
  out.y = out.y(measured).eval();
  return out;
}

/// The windows of some rows.
Windows windows_at(const Windows& all, const std::vector<Index>& rows) {
  Windows out;
  out.centre_s = all.centre_s(rows);
  out.duration_s = all.duration_s(rows);
  out.white_floor = all.white_floor(rows);
  if (all.white_scale.size() > 0) out.white_scale = all.white_scale(rows);
  std::size_t run = all.run_begin.size();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::size_t its = 0;
    while (static_cast<std::size_t>(rows[i]) >= all.run_begin[its + 1]) ++its;
    if (its != run) out.run_begin.push_back(i);
    run = its;
  }
  out.run_begin.push_back(rows.size());
  return out;
}

/// The rows that a fold leaves out, and those that it fits.
struct Fold {
  std::vector<Index> kept, left;
};

std::vector<Fold> folds_of(const std::vector<Index>& rows) {
  const std::size_t n = rows.size(), folds = std::min(kFolds, n);
  std::vector<Fold> out(folds);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t block = i * folds * kBlocksPerFold / n;
    for (std::size_t fold = 0; fold < folds; ++fold) {
      (block % folds == fold ? out[fold].left : out[fold].kept).push_back(rows[i]);
    }
  }
  // Of few rows not every fold gets one.
  std::erase_if(out, [](const Fold& fold) { return fold.left.empty(); });
  return out;
}

/// Coefficients of least squares, whatever the columns' lengths and dependences.
VectorXd solve(const MatrixXd& x, const VectorXd& y) {
  if (x.cols() == 0) return VectorXd(0);
  VectorXd lengths = x.colwise().stableNorm();
  for (double& length : lengths) length = length > 0.0 ? length : 1.0;
  const MatrixXd scaled = x * lengths.cwiseInverse().asDiagonal();
  return Eigen::CompleteOrthogonalDecomposition<MatrixXd>(scaled).solve(y).cwiseQuotient(lengths);
}

/// The rows' weights: those of the white noise alone. Under a walk the weighted bias is that of a
/// few rows, and the wandering of all others would count as misfit.
std::unique_ptr<Whitener> weights_of(const Windows& windows, const NoiseCoefficients& noise) {
  if (!(noise.angle_random_walk_deg_per_sqrt_h > 0.0)) return nullptr;
  auto made = make_whitener(
      windows, {.angle_random_walk_deg_per_sqrt_h = noise.angle_random_walk_deg_per_sqrt_h});
  return made ? std::move(*made) : nullptr;
}

/// Errors of the left-out rows that the kept ones predict, in the observable's unit, by least
/// squares on rows that have been multiplied by their `weight`; nothing when the kept ones do not
/// determine all coefficients.
std::optional<VectorXd> predicted_badly(const MatrixXd& x, const VectorXd& y,
                                        const VectorXd& weight, const Fold& fold, Index rank) {
  const VectorXd unit = weight(fold.left).cwiseInverse();
  if (x.cols() == 0) return y(fold.left).cwiseProduct(unit);
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(x(fold.kept, Eigen::all));
  if (qr.rank() < rank) return std::nullopt;  // the block held something that nothing else shows
  const MatrixXd left = x(fold.left, Eigen::all);
  const VectorXd errors = (y(fold.left) - left * qr.solve(y(fold.kept))).cwiseProduct(unit);
  // Of the predictions' variance, in units of a row's own.
  const Index p = qr.rank();
  if (p == 0) return y(fold.left).cwiseProduct(unit);  // columns of nothing
  const MatrixXd ordered = (left * qr.colsPermutation()).leftCols(p);
  const VectorXd uncertain = qr.matrixQR()
                                 .topLeftCorner(p, p)
                                 .template triangularView<Eigen::Upper>()
                                 .transpose()
                                 .solve(ordered.transpose())
                                 .colwise()
                                 .squaredNorm();
  std::vector<Index> told;
  for (Index i = 0; i < errors.size(); ++i) {
    if (uncertain[i] < kLessThanItself) told.push_back(i);
  }
  return errors(told);
}

/// How well rows that were left out are predicted.
struct Predicted {
  double cost = 0.0;        ///< what independent unit errors would add up to
  Index unpredictable = 0;  ///< directions of which the other rows say nothing
};

/// A model's columns cleared from the data under the noise: all that leaving rows out asks of it.
///
///   P = Omega^-1 - Omega^-1 X (X' Omega^-1 X)^-1 X' Omega^-1
///   e_L = (P_LL)^-1 (P y)_L,   cost = e_L' (Omega^-1)_LL e_L
///
/// e_L is what is left of rows L when model and noise of the others have predicted them, exactly
/// and without a refit. Where P_LL is singular nothing but L itself shows a column.
class Cleared {
 public:
  /// root: L^-1 with Omega = L L'.
  Cleared(const MatrixXd& root, const MatrixXd& x, const VectorXd& y) : residual_(root * y) {
    q_.resize(root.rows(), 0);
    if (x.cols() > 0) {
      const MatrixXd whitened = root * x;
      const Eigen::ColPivHouseholderQR<MatrixXd> qr(whitened);
      q_ = qr.householderQ() * MatrixXd::Identity(root.rows(), qr.rank());
    }
    residual_ -= q_ * (q_.transpose() * residual_);
  }

  /// `part`: the columns of the root at L; `known`: of (Omega^-1)_LL.
  Predicted left_out(const MatrixXd& part, const Eigen::LLT<MatrixXd>& known) const {
    MatrixXd seen(part.cols(), 0);
    if (q_.cols() > 0) seen = known.matrixL().solve(part.transpose() * q_);
    const VectorXd scores = known.matrixL().solve(part.transpose() * residual_);
    const MatrixXd share = MatrixXd::Identity(seen.rows(), seen.rows()) - seen * seen.transpose();
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(share);
    Predicted out;
    for (Index i = 0; i < share.rows(); ++i) {
      const double value = eigen.eigenvalues()[i];
      if (value < kUnpredictable) {
        ++out.unpredictable;
        continue;
      }
      const double error = eigen.eigenvectors().col(i).dot(scores) / value;
      out.cost += error * error;
    }
    return out;
  }

 private:
  MatrixXd q_;
  VectorXd residual_;
};

}  // namespace

std::vector<HeldoutVote> heldout_votes(const Windows& windows, const NoiseCoefficients& noise,
                                       const MatrixXd& with, const std::vector<MatrixXd>& without,
                                       const VectorXd& y, Index bench_rows) {
  const auto whitener = make_whitener(windows, noise);
  if (!whitener) return {};
  const MatrixXd root = (*whitener)->whiten(MatrixXd::Identity(windows.rows(), windows.rows()));
  const Cleared full(root, with, y);
  std::vector<Cleared> smaller;
  for (const MatrixXd& columns : without) smaller.emplace_back(root, columns, y);

  std::vector<Index> bench(static_cast<std::size_t>(bench_rows));
  std::iota(bench.begin(), bench.end(), Index{0});
  std::vector<HeldoutVote> votes(without.size());
  for (const Fold& fold : folds_of(bench)) {
    const MatrixXd part = root(Eigen::all, fold.left);
    const Eigen::LLT<MatrixXd> known(part.transpose() * part);
    if (known.info() != Eigen::Success) continue;
    const Predicted ours = full.left_out(part, known);
    for (std::size_t i = 0; i < without.size(); ++i) {
      const Predicted theirs = smaller[i].left_out(part, known);
      // The other rows do not show what the part alone holds: no vote.
      if (ours.unpredictable > theirs.unpredictable) continue;
      const double gain = theirs.cost - ours.cost;
      votes[i].gain += gain;
      if (std::abs(gain) < kNoDifference) continue;
      votes[i].better += gain > 0.0 ? 1 : 0;
      ++votes[i].folds;
    }
  }
  return votes;
}

double heldout_rms(const Windows& windows, const NoiseCoefficients& noise, const MatrixXd& x,
                   const VectorXd& y, Index bench_rows) {
  std::vector<Index> bench, quiet;
  for (Index i = 0; i < y.size(); ++i) {
    if (x.row(i).allFinite() && std::isfinite(y[i])) (i < bench_rows ? bench : quiet).push_back(i);
  }
  const Index p = x.cols();
  if (std::ssize(bench) < p + 2) return kMissing;
  std::vector<Index> rows = bench;
  rows.insert(rows.end(), quiet.begin(), quiet.end());
  MatrixXd columns = x(rows, Eigen::all);
  VectorXd seen = y(rows);
  VectorXd weight = VectorXd::Ones(seen.size());
  if (const auto weights = weights_of(windows_at(windows, rows), noise)) {
    columns = weights->whiten(columns);
    seen = weights->whiten(seen);
    weight = weights->whiten(weight);
  }
  const Index rank =
      p > 0 ? Eigen::ColPivHouseholderQR<MatrixXd>(columns.topRows(std::ssize(bench))).rank() : 0;
  std::iota(rows.begin(), rows.end(), Index{0});
  double squares = 0.0;
  Index count = 0;
  for (Fold& fold : folds_of({rows.begin(), rows.begin() + std::ssize(bench)})) {
    fold.kept.insert(fold.kept.end(), rows.begin() + std::ssize(bench), rows.end());
    if (std::ssize(fold.kept) < p) continue;
    const auto told = predicted_badly(columns, seen, weight, fold, rank);
    if (!told) continue;
    squares += told->squaredNorm();
    count += told->size();
  }
  return count > 0 ? std::sqrt(squares / static_cast<double>(count)) : kMissing;
}

double heldout_rms(const Table& table, const Windows& windows, const config::ModelFile& fitted,
                   const NoiseCoefficients& noise) {
  const Signals signals(table, fitted.reference_temperature_c);
  const auto system = system_of(signals, fitted);
  if (!system) return kMissing;
  // How a memory began is the data's own, and rows that are left out may tell it too.
  VectorXd y = system->y;
  const Index own = system->x.cols() - system->starts;
  std::vector<Index> complete;
  for (Index i = 0; i < y.size(); ++i) {
    if (system->x.row(i).allFinite()) complete.push_back(i);
  }
  if (system->starts > 0 && !complete.empty()) {
    MatrixXd x = system->x(complete, Eigen::all);
    VectorXd seen = y(complete);
    if (const auto whitener = weights_of(windows_at(windows, complete), noise)) {
      x = whitener->whiten(x);
      seen = whitener->whiten(seen);
    }
    y -= system->x.rightCols(system->starts) * solve(x, seen).tail(system->starts);
  }
  return heldout_rms(windows, noise, system->x.leftCols(own), y, y.size());
}

double least_squares_rms(const Table& table, const config::ModelFile& fitted) {
  const Signals signals(table, fitted.reference_temperature_c);
  const auto system = system_of(signals, fitted);
  if (!system) return kMissing;
  std::vector<Index> complete;
  for (Index i = 0; i < system->y.size(); ++i) {
    if (system->x.row(i).allFinite()) complete.push_back(i);
  }
  if (complete.empty()) return kMissing;
  const MatrixXd x = system->x(complete, Eigen::all);
  const VectorXd left = system->y(complete) - x * solve(x, system->y(complete));
  return left.stableNorm() / std::sqrt(static_cast<double>(left.size()));
}

}  // namespace fogbench::model
