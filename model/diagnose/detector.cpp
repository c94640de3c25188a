#include "model/diagnose/detector.hpp"

#include <Eigen/Dense>
#include <limits>
#include <set>
#include <utility>

#include "model/diagnose/detector_view.hpp"
#include "model/noise/shape_grid.hpp"

namespace fogbench::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::MatrixXf;
using Eigen::VectorXd;

// A column is not testable when the base leaves less than this of its whitened length.
constexpr double kLeastLeft = 1e-3;
// Shapes whose likelihood is below this fraction of the best, without a candidate and with one, are
// not kept: they cannot move any statistic.
constexpr double kLeastShape = 1e-3;
constexpr double kShares[] = {0.0, 0.5, 0.8, 0.9, 0.97, 1.0};
// What a point of a grid between those of the sample may gain, as a log-likelihood.
constexpr double kUnsampled = 5.0;
constexpr std::size_t kMostShapes = 12;
constexpr double kMinusInfinity = -std::numeric_limits<double>::infinity();

std::size_t count_blocks(const Library& library) {
  std::size_t n = 0;
  for (const Candidate& c : library.candidates) n += c.blocks.size();
  return n;
}

/// Makes the block's columns orthonormal in place. A column of which the others and the base leave
/// less than kLeastLeft drops out, and the block lives on the rest; false when none is left.
bool orthonormalise(Eigen::Ref<MatrixXd> block, const VectorXd& lengths_before) {
  bool alive = false;
  for (Index j = 0; j < block.cols(); ++j) {
    for (int pass = 0; pass < 2; ++pass) {
      for (Index i = 0; i < j; ++i) {
        block.col(j) -= block.col(i).dot(block.col(j)) * block.col(i);
      }
    }
    const double left = block.col(j).norm();
    if (left > kLeastLeft * lengths_before[j]) {
      block.col(j) /= left;
      alive = true;
    } else {
      block.col(j).setZero();
    }
  }
  return alive;
}

}  // namespace

Detector::Detector(const WhitenedLibrary& whitened, const MatrixXd& base, const VectorXd& y)
    : shapes_(whitened.shapes()),
      base_(base),
      library_(whitened.tried()),
      y_(y),
      nu_(static_cast<double>(base.rows() - base.cols())),
      evidence_(nu_, shapes_.anchor()) {
  const std::size_t blocks = count_blocks(library_);
  ShapeGrid grid(shapes_);
  std::vector<std::shared_ptr<View>> all;
  std::vector<double> null_likelihood, best_likelihood, gain;

  // What the best of some blocks explains, and which it is; made orthonormal in place.
  const auto explained = [](const View& view, MatrixXd& z, const VectorXd& lengths,
                            const std::vector<Block>& of, std::vector<bool>* living) {
    std::pair<double, std::size_t> most{0.0, 0};
    for (std::size_t i = 0; i < of.size(); ++i) {
      const Block& b = of[i];
      auto part = z.middleCols(b.first, b.width);
      const bool alive = orthonormalise(part, lengths.segment(b.first, b.width));
      if (!alive) part.setZero();
      if (living != nullptr) living->push_back(alive);
      const double its = (part.transpose() * view.residual).squaredNorm();
      if (its > most.first) most = {its, i};
    }
    return most;
  };

  // Most noise shapes are hopeless, with each candidate as without: a sample of the candidates
  // tells, and on a finer grid those that led on the coarse one.
  MatrixXd sampled = whitened.sampled();
  std::vector<Block> sample = whitened.sample();
  std::vector<std::size_t> leading;
  const auto keep_the_leading = [&] {
    const double best = *std::max_element(best_likelihood.begin(), best_likelihood.end());
    std::set<std::size_t> kept;
    for (std::size_t k = 0; k < leading.size(); ++k) {
      if (!sample.empty() && best_likelihood[k] > best - kUnsampled) kept.insert(leading[k]);
    }
    std::vector<Block> their;
    std::vector<Index> columns;
    for (const std::size_t i : kept) {
      Block block = sample[i];
      for (Index j = 0; j < block.width; ++j) columns.push_back(block.first + j);
      block.first = std::ssize(columns) - block.width;
      their.push_back(block);
    }
    sampled = MatrixXd(sampled(Eigen::all, columns));
    sample = std::move(their);
  };
  do {
    const std::size_t first = all.size();
    if (first > 0 && !leading.empty()) keep_the_leading();
    leading.resize(first == 0 ? grid.size() : 0);
    all.resize(grid.size());
    null_likelihood.resize(grid.size());
    best_likelihood.resize(grid.size());
    gain.resize(grid.size());
    in_parallel(grid.size() - first, [&](std::size_t i) {
      const std::size_t k = first + i;
      auto view = std::make_shared<View>();
      view->whitener = grid.whitener(k);
      const MatrixXd wx = view->whitener->whiten(base_);
      const Eigen::HouseholderQR<MatrixXd> qr(wx);
      view->q = qr.householderQ() * MatrixXd::Identity(wx.rows(), wx.cols());
      view->log_prior = -0.5 * view->whitener->log_determinant() -
                        qr.matrixQR().diagonal().cwiseAbs().array().log().sum();
      view->residual = view->project(view->whitener->whiten(y_));
      view->squares = view->residual.squaredNorm();
      null_likelihood[k] = view->log_prior + evidence_(view->squares);
      MatrixXd z = view->whitener->whiten(sampled);
      const VectorXd lengths = z.colwise().norm();
      z = view->project(std::move(z));
      const auto [most, which] = explained(*view, z, lengths, sample, nullptr);
      if (first == 0) leading[k] = which;
      gain[k] = most;
      best_likelihood[k] = view->log_prior + evidence_(view->squares - most);
      all[k] = std::move(view);
    });
  } while (grid.refine({null_likelihood, best_likelihood}));
  for (std::size_t k = 0; k < all.size(); ++k) all[k]->log_prior += grid.log_prior(k);
  // A shape counts when it is likely for a candidate that explains such a share of what the best
  // one does: rivals leave more than the leader, and the noise of their world is another one.
  const auto merits = [&] {
    std::vector<double> out(all.size(), kMinusInfinity);
    for (const double share : kShares) {
      std::vector<double> likelihood(all.size());
      for (std::size_t k = 0; k < all.size(); ++k) {
        likelihood[k] = all[k]->log_prior + evidence_(all[k]->squares - share * gain[k]);
      }
      const double best = *std::max_element(likelihood.begin(), likelihood.end());
      for (std::size_t k = 0; k < all.size(); ++k) {
        out[k] = std::max(out[k], likelihood[k] - best);
      }
    }
    return out;
  };
  std::vector<double> merit = merits();
  std::vector<std::size_t> hopeful;
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (merit[k] > std::log(kLeastShape) - kUnsampled) hopeful.push_back(k);
  }
  std::sort(hopeful.begin(), hopeful.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(-merit[a], a) < std::pair(-merit[b], b);
  });
  if (hopeful.size() > kMostShapes) hopeful.resize(kMostShapes);
  in_parallel(hopeful.size(), [&](std::size_t i) {
    const std::size_t k = hopeful[i];
    View& view = *all[k];
    MatrixXd z = *whitened.under(grid.shape(k), *view.whitener);
    const VectorXd lengths = z.colwise().norm();
    z = view.project(std::move(z));
    view.alive.reserve(blocks);
    double most = 0.0;
    for (const Candidate& c : library_.candidates) {
      most = std::max(most, explained(view, z, lengths, c.blocks, &view.alive).first);
    }
    gain[k] = most;
    view.u = z.cast<float>();
  });
  merit = merits();

  std::vector<std::pair<double, std::size_t>> ranked;
  for (const std::size_t k : hopeful) {
    if (merit[k] > std::log(kLeastShape)) ranked.emplace_back(-merit[k], k);
  }
  std::sort(ranked.begin(), ranked.end());
  for (const auto& [worse, k] : ranked) views_.push_back(all[k]);

  std::size_t index = 0;
  for (Index c = 0; c < candidates(); ++c) {
    Living living{c, {}};
    for (const Block& block : library_.candidates[static_cast<std::size_t>(c)].blocks) {
      if (views_.front()->alive[index++]) living.blocks.push_back(&block);
    }
    if (!living.blocks.empty()) living_.push_back(std::move(living));
  }
  best_block_.assign(library_.candidates.size(), 0);
  observed_ = scan(data_as_draw(), {}, Among::kAll, &best_block_);
}

const Block& Detector::best_block(Index candidate) const {
  const auto c = static_cast<std::size_t>(candidate);
  return library_.candidates[c].blocks[best_block_[c]];
}

bool Detector::testable(Index candidate) const {
  return observed_[candidate] >= 0.0;
}

double Detector::lambda_of(const MatrixXd& columns) const {
  std::vector<double> null(views_.size()), with(views_.size());
  for (std::size_t v = 0; v < views_.size(); ++v) {
    const View& view = *views_[v];
    MatrixXd z = view.whitener->whiten(columns);
    const VectorXd lengths = z.colwise().norm();
    z = view.project(std::move(z));
    if (!orthonormalise(z, lengths)) return -1.0;
    null[v] = view.log_prior + evidence_(view.squares);
    with[v] =
        view.log_prior + evidence_(view.squares - (z.transpose() * view.residual).squaredNorm());
  }
  return 2.0 * (log_sum_exp(with) - log_sum_exp(null));
}

std::size_t Detector::best_view(Index candidate) const {
  const Block& b = best_block(candidate);
  std::size_t best = 0;
  double top = kMinusInfinity;
  for (std::size_t v = 0; v < views_.size(); ++v) {
    const double gain =
        (views_[v]->u.middleCols(b.first, b.width).transpose().cast<double>() * views_[v]->residual)
            .squaredNorm();
    const double l = views_[v]->log_prior + evidence_(views_[v]->squares - gain);
    if (l > top) {
      top = l;
      best = v;
    }
  }
  return best;
}

Detector::Coefficients Detector::coefficients(Index candidate) const {
  const Block& b = best_block(candidate);
  const View& view = *views_[best_view(candidate)];
  const MatrixXd z =
      view.project(view.whitener->whiten(library_.columns.middleCols(b.first, b.width)));
  // Columns that the base makes dependent (cos and sin at two azimuths) share what they explain.
  Eigen::CompleteOrthogonalDecomposition<MatrixXd> decomposition;
  decomposition.setThreshold(kLeastLeft);
  decomposition.compute(z);
  Coefficients out;
  out.value = decomposition.solve(view.residual);
  const double left = (view.residual - z * out.value).squaredNorm();
  const double white2 = std::max(left / std::max(nu_ - static_cast<double>(b.width), 1.0),
                                 shapes_.anchor() * shapes_.anchor());
  out.standard_error = std::sqrt(white2) * decomposition.pseudoInverse().rowwise().norm();
  return out;
}

VectorXd Detector::fitted_signal(Index candidate) const {
  const Block& b = best_block(candidate);
  return library_.columns.middleCols(b.first, b.width) * coefficients(candidate).value;
}

}  // namespace fogbench::model
