#include "model/next/separation.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "model/effects/catalogue.hpp"
#include "model/fit/design.hpp"
#include "model/table/moving_signals.hpp"

namespace fogbench::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kDependent = 1e-9;  // of a normalised column: spanned by those before it
// A rival's column that the base leaves less than this of is no rival of its own.
constexpr double kNothingLeft = 1e-12;
constexpr Index kNoiseWindows = 24;

MatrixXd finite(const MatrixXd& columns) {
  return columns.array().isFinite().select(columns, 0.0);
}

std::vector<double> grid_of(const Effect& effect, const Signals& present, int points) {
  const InnerParameter& parameter = effect.info().parameters.front();
  std::vector<double> grid;
  double least = parameter.minimum, most = parameter.maximum;
  if (!parameter.within.empty()) {
    const auto range = present.signal(parameter.within);
    least = range.minCoeff();
    most = range.maxCoeff();
  }
  for (int i = 0; i < points; ++i) {
    // Instants lie inside the range: a jump before the first row or after the last is a bias.
    const double t = effect.info().is_jump() ? (i + 1.0) / (points + 1.0)
                                             : static_cast<double>(i) / std::max(points - 1, 1);
    const bool logarithmic = parameter.logarithmic && least > 0.0;
    grid.push_back(logarithmic ? least * std::pow(most / least, t) : least + t * (most - least));
  }
  return grid;
}

/// The model's free columns with the tangents of its inner parameters. A model that cannot be
/// evaluated here (an expression over what only the present table holds) gives the rest of it.
MatrixXd design_columns(const Signals& signals, config::ModelFile model) {
  const auto rows = static_cast<Index>(signals.rows());
  auto design = Design::make(signals, model, false);
  if (!design) {
    std::erase_if(model.terms, [](const config::ModelTerm& t) { return t.expression.has_value(); });
    design = Design::make(signals, model, false);
  }
  if (!design) return MatrixXd(rows, 0);
  VectorXd inner(static_cast<Index>(design->parameters().size()));
  for (Index i = 0; i < inner.size(); ++i) {
    inner[i] = design->parameters()[static_cast<std::size_t>(i)].start.value_or(1.0);
  }
  MatrixXd out;
  const VectorXd observed = VectorXd::Zero(rows);
  design->visit(inner, true, Signals::View(observed.data(), rows),
                [&](std::size_t begin, Eigen::Ref<MatrixXd> block) {
                  if (out.size() == 0) out.resize(rows, block.cols() - 1);
                  out.middleRows(static_cast<Index>(begin), block.rows()) =
                      block.leftCols(block.cols() - 1);
                });
  return finite(out);
}

config::ModelFile without(config::ModelFile model, const std::vector<const Effect*>& effects) {
  std::erase_if(model.terms, [&](const config::ModelTerm& term) {
    return !term.expression && std::any_of(effects.begin(), effects.end(), [&](const Effect* e) {
      return e->info().id == term.effect;
    });
  });
  for (config::ModelTerm& term : model.terms) {
    if (term.fixed) continue;
    term.coefficient.reset();
    term.coefficients.clear();
  }
  model.fit.reset();
  return model;
}

MatrixXd upper_triangle(const MatrixXd& rows) {
  const Index n = std::min(rows.rows(), rows.cols());
  const Eigen::HouseholderQR<MatrixXd> qr(rows);
  return qr.matrixQR().topRows(n).triangularView<Eigen::Upper>();
}

MatrixXd whitened(const Windows& windows, const NoiseCoefficients& noise, const MatrixXd& rows) {
  const auto whitener = make_whitener(windows, noise);
  if (!whitener) return MatrixXd(0, rows.cols());
  return (*whitener)->whiten(rows);
}

}  // namespace

Separation::Separation(const Recorded& present, const config::ModelFile& fitted,
                       const std::vector<const Effect*>& effects,
                       const std::vector<std::vector<double>>& inner,
                       const NoiseCoefficients& noise, int grid_points)
    : present_(present), base_model_(without(fitted, effects)), noise_(noise) {
  const Signals signals(present.table, base_model_.reference_temperature_c);
  for (std::size_t m = 0; m < effects.size(); ++m) {
    const auto width = static_cast<Index>(effects[m]->info().columns.size());
    Member member{.effect = effects[m], .blocks = {}};
    const auto add = [&](const std::vector<double>& values) {
      member.blocks.push_back({columns_, width, values, false});
      columns_ += width;
    };
    if (!inner[m].empty()) add(inner[m]);
    if (effects[m]->info().parameters.empty()) {
      if (member.blocks.empty()) add({});
    } else {
      for (const double value : grid_of(*effects[m], signals, grid_points)) add({value});
    }
    if (effects[m]->info().is_jump()) {
      const std::size_t known = member.blocks.size();
      for (std::size_t i = 0; i < known; ++i) {
        add(member.blocks[i].inner);
        member.blocks.back().once = true;
      }
    }
    members_.push_back(std::move(member));
  }
  const MatrixXd rows = whitened(present.windows, noise_, rows_of(present, false));
  base_ = rows.cols() - columns_;
  if (rows.rows() == 0) return;
  triangle_ = upper_triangle(rows);
  present_gram_ = gram_of(triangle_, base_);
}

MatrixXd Separation::rows_of(const Recorded& run, bool again) const {
  const Signals signals(run.table, base_model_.reference_temperature_c);
  const MatrixXd base = design_columns(signals, base_model_);
  const bool biased =
      std::any_of(base_model_.terms.begin(), base_model_.terms.end(),
                  [](const config::ModelTerm& t) { return !t.expression && t.effect == "bias"; });
  MatrixXd out(base.rows(), base.cols() + 1 + columns_);
  out << base, VectorXd::Constant(base.rows(), again && biased ? 1.0 : 0.0),
      MatrixXd::Zero(base.rows(), columns_);
  for (const Member& member : members_) {
    for (const GramBlock& block : member.blocks) {
      if (again && block.once) continue;
      out.middleCols(base.cols() + 1 + block.first, block.width) =
          finite(member.effect->regressor(signals, block.inner));
    }
  }
  return out;
}

MatrixXd Separation::new_to_the_model(const Recorded& more) const {
  const Signals before(present_.table, base_model_.reference_temperature_c);
  const Signals after(more.table, base_model_.reference_temperature_c);
  MatrixXd out(static_cast<Index>(after.rows()), 0);
  for (const Effect* effect : catalogue()) {
    const std::string& signal = effect->info().elementary_in;
    if (signal.empty()) continue;
    const double least = least_excitation(signal);
    if (!moving_signal(after, signal, least) || moving_signal(before, signal, least)) continue;
    const bool member = std::any_of(members_.begin(), members_.end(),
                                    [&](const Member& m) { return m.effect == effect; });
    if (member || !after.missing_for(effect->info()).empty()) continue;
    const MatrixXd columns = finite(effect->regressor(after, {}));
    out.conservativeResize(Eigen::NoChange, out.cols() + columns.cols());
    out.rightCols(columns.cols()) = columns;
  }
  return out;
}

MatrixXd Separation::gram_of(const MatrixXd& rows, Index base) const {
  MatrixXd basis(rows.rows(), 0);
  for (Index j = 0; j < base; ++j) {
    const double length = rows.col(j).norm();
    if (!(length > 0.0)) continue;
    VectorXd left = rows.col(j) / length;
    for (int pass = 0; pass < 2; ++pass) left -= basis * (basis.transpose() * left).eval();
    if (left.norm() < kDependent) continue;
    basis.conservativeResize(Eigen::NoChange, basis.cols() + 1);
    basis.rightCols(1) = left.normalized();
  }
  MatrixXd z = rows.rightCols(columns_);
  for (int pass = 0; pass < 2; ++pass) z -= basis * (basis.transpose() * z).eval();
  return z.transpose() * z;
}

MatrixXd Separation::with(const Recorded& more) const {
  const MatrixXd fresh = new_to_the_model(more);
  const MatrixXd known = rows_of(more, true);
  MatrixXd rows(known.rows(), fresh.cols() + known.cols());
  rows << fresh, known;
  rows = whitened(more.windows, noise_, rows);
  if (rows.rows() == 0 || known.cols() != triangle_.cols()) return present_gram_;
  MatrixXd both(triangle_.rows() + rows.rows(), rows.cols());
  both << MatrixXd::Zero(triangle_.rows(), fresh.cols()), triangle_, rows;
  return gram_of(both, fresh.cols() + base_);
}

double Separation::squared(const MatrixXd& gram, std::size_t member, const Truth& truth) const {
  const GramBlock& a = members_[member].blocks[truth.block];
  return std::max(0.0, truth.beta.dot(gram.block(a.first, a.first, a.width, a.width) * truth.beta));
}

Truth Separation::nearest(const MatrixXd& gram, std::size_t member, const Truth& truth,
                          std::size_t rival) const {
  const GramBlock& a = members_[member].blocks[truth.block];
  Truth best{.block = 0, .beta = {}};
  double most = -1.0;
  for (std::size_t i = 0; i < members_[rival].blocks.size(); ++i) {
    const GramBlock& b = members_[rival].blocks[i];
    const MatrixXd gbb = gram.block(b.first, b.first, b.width, b.width);
    const VectorXd c = gram.block(b.first, a.first, b.width, a.width) * truth.beta;
    VectorXd beta = VectorXd::Zero(b.width);
    if (gbb.trace() > kNothingLeft) {
      Eigen::ColPivHouseholderQR<MatrixXd> solver(gbb);
      solver.setThreshold(kDependent);
      beta = solver.solve(c);
    }
    const double explained = c.dot(beta);
    if (explained > most) {
      most = explained;
      best = {.block = i, .beta = std::move(beta)};
    }
  }
  return best;
}

double Separation::squared(const MatrixXd& gram, std::size_t member, const Truth& truth,
                           std::size_t rival) const {
  const Truth other = nearest(gram, member, truth, rival);
  const GramBlock& a = members_[member].blocks[truth.block];
  const GramBlock& b = members_[rival].blocks[other.block];
  const double explained =
      other.beta.dot(gram.block(b.first, a.first, b.width, a.width) * truth.beta);
  return std::max(0.0, squared(gram, member, truth) - explained);
}

MatrixXd Separation::present_columns(std::size_t member, std::size_t block) const {
  const Signals signals(present_.table, base_model_.reference_temperature_c);
  return finite(members_[member].effect->regressor(signals, members_[member].blocks[block].inner));
}

double squared_noise_separation(double hours, const NoiseCoefficients& truth,
                                const NoiseCoefficients& rival) {
  const double window_s = 3600.0 * hours / static_cast<double>(kNoiseWindows);
  Windows windows;
  windows.run_begin = {0, static_cast<std::size_t>(kNoiseWindows)};
  windows.centre_s =
      (VectorXd::LinSpaced(kNoiseWindows, 0.5, static_cast<double>(kNoiseWindows) - 0.5)) *
      window_s;
  windows.duration_s = VectorXd::Constant(kNoiseWindows, window_s);
  windows.white_floor = VectorXd::Zero(kNoiseWindows);
  const auto a = noise_covariance(windows, truth);
  const auto b = noise_covariance(windows, rival);
  if (!a || !b) return 0.0;
  // Differences of neighbouring windows: all but the bias.
  MatrixXd difference = MatrixXd::Zero(kNoiseWindows - 1, kNoiseWindows);
  difference.diagonal(0).setConstant(-1.0);
  difference.diagonal(1).setConstant(1.0);
  const Eigen::LLT<MatrixXd> la(difference * *a * difference.transpose());
  const Eigen::LLT<MatrixXd> lb(difference * *b * difference.transpose());
  if (la.info() != Eigen::Success || lb.info() != Eigen::Success) return 0.0;
  const MatrixXd ratio = lb.matrixL().solve(MatrixXd(la.matrixL()));
  const double log_determinants = 2.0 * (MatrixXd(lb.matrixL()).diagonal().array().log().sum() -
                                         MatrixXd(la.matrixL()).diagonal().array().log().sum());
  return std::max(0.0,
                  ratio.squaredNorm() - static_cast<double>(kNoiseWindows - 1) + log_determinants);
}

}  // namespace fogbench::model
