#include "model/diagnose/heldout.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "model/design.hpp"
#include "model/signals.hpp"

namespace fogbench::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kFolds = 8;
// Each fold leaves out this many blocks, far apart: one block that held a whole sweep would ask for
// an extrapolation.
constexpr std::size_t kBlocksPerFold = 3;

struct System {
  MatrixXd x;
  VectorXd y;
  std::vector<Index> complete;  // rows without a missing number
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
  for (Index i = 0; i < n; ++i) {
    if (out.x.row(i).allFinite() && std::isfinite(out.y[i])) out.complete.push_back(i);
  }
  return out;
}

/// The windows of some rows.
Windows windows_at(const Windows& all, const std::vector<Index>& rows) {
  Windows out;
  out.centre_s = all.centre_s(rows);
  out.duration_s = all.duration_s(rows);
  out.white_floor = all.white_floor(rows);
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

}  // namespace

double heldout_rms(const Table& table, const Windows& windows, const config::ModelFile& fitted,
                   const NoiseCoefficients& noise) {
  const Signals signals(table, fitted.reference_temperature_c);
  const auto system = system_of(signals, fitted);
  if (!system) return kMissing;
  const auto n = system->complete.size();
  const auto p = static_cast<std::size_t>(system->x.cols());
  const std::size_t folds = std::min(kFolds, n);
  if (n < p + 2 || folds < 2) return kMissing;

  const Index rank =
      p > 0 ? Eigen::ColPivHouseholderQR<MatrixXd>(system->x(system->complete, Eigen::all)).rank()
            : 0;
  double squares = 0.0;
  std::size_t count = 0;
  for (std::size_t fold = 0; fold < folds; ++fold) {
    std::vector<Index> kept, left;
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t block = i * folds * kBlocksPerFold / n;
      (block % folds == fold ? left : kept).push_back(system->complete[i]);
    }
    if (kept.size() < p) continue;
    MatrixXd x = system->x(kept, Eigen::all);
    VectorXd y = system->y(kept);
    if (noise.angle_random_walk_deg_per_sqrt_h > 0.0) {
      if (const auto whitener = make_whitener(windows_at(windows, kept), noise)) {
        x = (*whitener)->whiten(x);
        y = (*whitener)->whiten(y);
      }
    }
    VectorXd beta(0);  // every term is held: nothing to fit
    if (p > 0) {
      const Eigen::ColPivHouseholderQR<MatrixXd> qr(x);
      if (qr.rank() < rank) continue;  // the block held something that nothing else shows
      beta = qr.solve(y);
    }
    squares += (system->y(left) - system->x(left, Eigen::all) * beta).squaredNorm();
    count += left.size();
  }
  return count > 0 ? std::sqrt(squares / static_cast<double>(count)) : kMissing;
}

}  // namespace fogbench::model
