#include "model/diagnose/detector.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <atomic>
#include <boost/random/chi_squared_distribution.hpp>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <cmath>
#include <limits>
#include <mutex>
#include <thread>

namespace fogbench::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::MatrixXf;
using Eigen::VectorXd;

// A column is not testable when the base leaves less than this of its whitened length.
constexpr double kLeastLeft = 1e-3;
// Shapes whose likelihood is below this fraction of the best, without and with every candidate, are
// not kept: they cannot move any statistic.
constexpr double kLeastShape = 1e-3;
constexpr std::size_t kMostShapes = 32;
constexpr double kLeastSquares = 1e-24;  // deg^2/h: keeps a perfect fit finite
constexpr double kMinusInfinity = -std::numeric_limits<double>::infinity();

/// Two workers share the items; results do not depend on who does which.
template <class Work>
void in_parallel(std::size_t items, Work work) {
  std::atomic<std::size_t> next{0};
  const auto worker = [&] {
    for (std::size_t i = next++; i < items; i = next++) work(i);
  };
  std::thread other;
  if (items > 1 && std::thread::hardware_concurrency() > 1) other = std::thread(worker);
  worker();
  if (other.joinable()) other.join();
}

double log_sum_exp(const std::vector<double>& values) {
  const double top = *std::max_element(values.begin(), values.end());
  double sum = 0.0;
  for (const double v : values) sum += v - top > -40.0 ? std::exp(v - top) : 0.0;
  return top + std::log(sum);
}

}  // namespace

struct Detector::View {
  std::size_t shape = 0;
  std::shared_ptr<const Whitener> whitener;
  MatrixXd q;               // basis of the whitened base
  MatrixXf u;               // candidates' columns: whitened, projected, orthonormal within a block
  std::vector<bool> alive;  // per block, in the library's order
  VectorXd residual;
  double squares = 0.0;
  double log_prior = 0.0;

  MatrixXd project(MatrixXd whitened) const {
    whitened.noalias() -= q * (q.transpose() * whitened).eval();
    return whitened;
  }
};

namespace {

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

Detector::Detector(const NoiseShapes& shapes, const MatrixXd& base, const Library& library,
                   const VectorXd& y)
    : shapes_(shapes),
      base_(base),
      library_(library),
      y_(y),
      nu_(static_cast<double>(base.rows() - base.cols())),
      evidence_(nu_, shapes.anchor()) {
  const std::size_t blocks = count_blocks(library);
  std::vector<std::shared_ptr<View>> all(shapes.size());
  std::vector<double> null_likelihood(shapes.size()), best_likelihood(shapes.size());

  // The library whitened under every shape would fill the memory: a shape that is hopeless beside
  // those seen so far is hopeless for good.
  std::mutex seen;
  double best_null = kMinusInfinity, best_with = kMinusInfinity;
  in_parallel(shapes.size(), [&](std::size_t k) {
    auto view = std::make_shared<View>();
    view->shape = k;
    view->whitener = shapes.whitener(k);
    const MatrixXd wx = view->whitener->whiten(base_);
    const Eigen::HouseholderQR<MatrixXd> qr(wx);
    view->q = qr.householderQ() * MatrixXd::Identity(wx.rows(), wx.cols());
    view->log_prior = shapes.log_prior(k) - 0.5 * view->whitener->log_determinant() -
                      qr.matrixQR().diagonal().cwiseAbs().array().log().sum();
    view->residual = view->project(view->whitener->whiten(y_));
    view->squares = view->residual.squaredNorm();

    MatrixXd z = view->whitener->whiten(library_.columns);
    const VectorXd lengths = z.colwise().norm();
    z = view->project(std::move(z));
    view->alive.reserve(blocks);
    double most = 0.0;
    for (const Candidate& c : library_.candidates) {
      for (const Block& b : c.blocks) {
        auto part = z.middleCols(b.first, b.width);
        const bool alive = orthonormalise(part, lengths.segment(b.first, b.width));
        if (!alive) part.setZero();
        view->alive.push_back(alive);
        most = std::max(most, (part.transpose() * view->residual).squaredNorm());
      }
    }
    null_likelihood[k] = view->log_prior + evidence_(view->squares);
    best_likelihood[k] = view->log_prior + evidence_(view->squares - most);
    {
      const std::lock_guard lock(seen);
      best_null = std::max(best_null, null_likelihood[k]);
      best_with = std::max(best_with, best_likelihood[k]);
      if (std::max(null_likelihood[k] - best_null, best_likelihood[k] - best_with) <
          std::log(kLeastShape)) {
        return;
      }
    }
    view->u = z.cast<float>();
    all[k] = std::move(view);
  });

  const double top_null = *std::max_element(null_likelihood.begin(), null_likelihood.end());
  const double top_best = *std::max_element(best_likelihood.begin(), best_likelihood.end());
  std::vector<std::pair<double, std::size_t>> ranked;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const double merit = std::max(null_likelihood[k] - top_null, best_likelihood[k] - top_best);
    if (merit > std::log(kLeastShape)) ranked.emplace_back(-merit, k);
  }
  std::sort(ranked.begin(), ranked.end());
  if (ranked.size() > kMostShapes) ranked.resize(kMostShapes);
  for (const auto& [merit, k] : ranked) views_.push_back(all[k]);

  const Draws data = data_as_draw();
  best_block_.assign(library_.candidates.size(), 0);
  observed_ = VectorXd::Constant(candidates(), -1.0);
  std::vector<double> base_likelihood(views_.size()), with(views_.size());
  for (std::size_t v = 0; v < views_.size(); ++v) {
    base_likelihood[v] = views_[v]->log_prior + evidence_(views_[v]->squares);
  }
  const double base_log = log_sum_exp(base_likelihood);
  std::size_t block_index = 0;
  for (std::size_t c = 0; c < library_.candidates.size(); ++c) {
    const auto& blocks_of = library_.candidates[c].blocks;
    for (std::size_t i = 0; i < blocks_of.size(); ++i, ++block_index) {
      bool alive = true;
      for (std::size_t v = 0; v < views_.size(); ++v) {
        alive = alive && views_[v]->alive[block_index];
        const double gain = data.scores[v]
                                .middleRows(blocks_of[i].first, blocks_of[i].width)
                                .cast<double>()
                                .squaredNorm();
        with[v] = views_[v]->log_prior + evidence_(views_[v]->squares - gain);
      }
      if (!alive) continue;
      const double lambda = 2.0 * (log_sum_exp(with) - base_log);
      auto& best = observed_[static_cast<Index>(c)];
      if (lambda > best) {
        best = lambda;
        best_block_[c] = i;
      }
    }
  }
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

Draws Detector::draw(Index count, std::uint64_t seed, Index with_candidate) const {
  // Posterior weights of the shapes, and what is left of the squares in each.
  std::vector<double> squares(views_.size()), weight(views_.size());
  for (std::size_t v = 0; v < views_.size(); ++v) {
    squares[v] = views_[v]->squares;
    if (with_candidate >= 0) {
      const Block& b = best_block(with_candidate);
      squares[v] -= (views_[v]->u.middleCols(b.first, b.width).transpose().cast<double>() *
                     views_[v]->residual)
                        .squaredNorm();
    }
    squares[v] = std::max(squares[v], kLeastSquares);
    weight[v] = views_[v]->log_prior + evidence_(squares[v]);
  }
  const double total = log_sum_exp(weight);
  for (double& w : weight) w = std::exp(w - total);

  boost::random::mt19937_64 engine(seed);
  boost::random::normal_distribution<double> normal;
  boost::random::uniform_real_distribution<double> uniform(0.0, 1.0);
  boost::random::chi_squared_distribution<double> chi2(std::max(nu_, 1.0));
  const double least = shapes_.anchor() * shapes_.anchor();

  std::vector<MatrixXd> made(views_.size());  // draws of each generating shape
  std::vector<std::vector<Index>> members(views_.size());
  std::vector<double> sizes(static_cast<std::size_t>(count));
  MatrixXd units(base_.rows(), count);
  for (Index b = 0; b < count; ++b) {
    double pick = uniform(engine);
    std::size_t v = 0;
    while (v + 1 < weight.size() && pick > weight[v]) pick -= weight[v++];
    members[v].push_back(b);
    double white2 = 0.0;
    constexpr int kTries = 1000;
    for (int t = 0; t < kTries && white2 <= least; ++t) white2 = squares[v] / chi2(engine);
    sizes[static_cast<std::size_t>(b)] = std::sqrt(std::max(white2, least));
    for (Index i = 0; i < units.rows(); ++i) units(i, b) = normal(engine);
  }
  MatrixXd noise(base_.rows(), count);
  in_parallel(views_.size(), [&](std::size_t v) {
    if (members[v].empty()) return;
    MatrixXd mine = views_[v]->whitener->colour(units(Eigen::all, members[v]));
    for (std::size_t i = 0; i < members[v].size(); ++i) {
      noise.col(members[v][i]) =
          mine.col(static_cast<Index>(i)) * sizes[static_cast<std::size_t>(members[v][i])];
    }
  });

  Draws draws;
  draws.count = count;
  draws.residuals.resize(views_.size());
  draws.scores.resize(views_.size());
  in_parallel(views_.size(), [&](std::size_t v) {
    draws.residuals[v] = views_[v]->project(views_[v]->whitener->whiten(noise)).cast<float>();
    draws.scores[v].noalias() = views_[v]->u.transpose() * draws.residuals[v];
  });
  return draws;
}

MatrixXd Detector::lambdas(const Draws& draws, const VectorXd& signal, Among among) const {
  const auto n_views = static_cast<Index>(views_.size());
  MatrixXd squares(n_views, draws.count);
  std::vector<Eigen::VectorXf> shift(views_.size());
  for (std::size_t v = 0; v < views_.size(); ++v) {
    auto row = squares.row(static_cast<Index>(v));
    row = draws.residuals[v].cast<double>().colwise().squaredNorm();
    if (signal.size() == 0) continue;
    const VectorXd s = views_[v]->project(views_[v]->whitener->whiten(signal));
    row += (2.0 * (s.cast<float>().transpose() * draws.residuals[v]).cast<double>()).matrix();
    row.array() += s.squaredNorm();
    shift[v] = views_[v]->u.transpose() * s.cast<float>();
  }
  // The blocks that take part, in the candidates' order.
  std::vector<const Block*> blocks;
  std::vector<Index> owner;
  std::size_t at = 0;
  for (Index c = 0; c < candidates(); ++c) {
    const Candidate& candidate = library_.candidates[static_cast<std::size_t>(c)];
    const bool wanted = among == Among::kAll || !candidate.shadow();
    for (const Block& block : candidate.blocks) {
      if (!views_[0]->alive[at++] || !wanted) continue;
      blocks.push_back(&block);
      owner.push_back(c);
    }
  }
  const auto n_blocks = static_cast<Index>(blocks.size());
  MatrixXd out = MatrixXd::Constant(candidates(), draws.count, -1.0);
  in_parallel(static_cast<std::size_t>(draws.count), [&](std::size_t draw) {
    const auto b = static_cast<Index>(draw);
    VectorXd base(n_views);
    Eigen::ArrayXXf with(n_blocks, n_views);
    Eigen::ArrayXf score;
    for (Index v = 0; v < n_views; ++v) {
      const auto k = static_cast<std::size_t>(v);
      const double q = std::max(squares(v, b), kLeastSquares);
      base[v] = views_[k]->log_prior + evidence_(q);
      score = draws.scores[k].col(b);
      if (shift[k].size() > 0) score += shift[k].array();
      score = score.square();
      for (Index i = 0; i < n_blocks; ++i) {
        const Block& block = *blocks[static_cast<std::size_t>(i)];
        with(i, v) =
            block.width == 1 ? score[block.first] : score.segment(block.first, block.width).sum();
      }
      constexpr float kMostExplained =
          1.0f - 1e-6f;  // of the squares; beyond it single precision ends
      with.col(v) = (1.0f - (with.col(v) / static_cast<float>(q)).min(kMostExplained)).log();
      evidence_.change(q, with.col(v));
    }
    // log sum exp over the views, both relative to the best view without any candidate.
    const double top = base.maxCoeff();
    const Eigen::ArrayXf relative = (base.array() - top).cast<float>();
    with.rowwise() += relative.transpose();
    const Eigen::ArrayXf most = with.rowwise().maxCoeff();
    const Eigen::ArrayXf gained = most + (with.colwise() - most).exp().rowwise().sum().log();
    const float null = std::log(relative.exp().sum());
    for (Index i = 0; i < n_blocks; ++i) {
      double& best = out(owner[static_cast<std::size_t>(i)], b);
      best = std::max(best, 2.0 * static_cast<double>(gained[i] - null));
    }
  });
  return out;
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
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(z);
  Coefficients out;
  out.value = qr.solve(view.residual);
  const double left = (view.residual - z * out.value).squaredNorm();
  const double white2 = std::max(left / std::max(nu_ - static_cast<double>(b.width), 1.0),
                                 shapes_.anchor() * shapes_.anchor());
  const MatrixXd inverse = (z.transpose() * z).completeOrthogonalDecomposition().pseudoInverse();
  out.standard_error = (white2 * inverse.diagonal()).cwiseMax(0.0).cwiseSqrt();
  return out;
}

MatrixXd Detector::lambdas_at_null_noise(const Draws& draws) const {
  std::vector<double> weight(views_.size());
  for (std::size_t v = 0; v < views_.size(); ++v) {
    weight[v] = views_[v]->log_prior + evidence_(views_[v]->squares);
  }
  const double total = log_sum_exp(weight);
  MatrixXd out = MatrixXd::Zero(candidates(), draws.count);
  for (std::size_t v = 0; v < views_.size(); ++v) {
    const double w = std::exp(weight[v] - total);
    if (w < 1e-4) continue;
    const VectorXd squares = draws.residuals[v].cast<double>().colwise().squaredNorm();
    std::size_t block_index = 0;
    for (Index c = 0; c < candidates(); ++c) {
      VectorXd best = VectorXd::Zero(draws.count);
      for (const Block& b : library_.candidates[static_cast<std::size_t>(c)].blocks) {
        if (!views_[v]->alive[block_index++]) continue;
        const VectorXd gain =
            draws.scores[v].middleRows(b.first, b.width).cast<double>().colwise().squaredNorm();
        best = best.cwiseMax(gain);
      }
      const Eigen::ArrayXd left = (1.0 - best.array() / squares.array()).max(1e-12);
      out.row(c) += (-w * nu_ * left.log()).matrix().transpose();
    }
  }
  return out;
}

VectorXd Detector::observed_at_null_noise() const {
  return lambdas_at_null_noise(data_as_draw());
}

Draws Detector::data_as_draw() const {
  Draws data;
  data.count = 1;
  for (const auto& view : views_) {
    data.residuals.emplace_back(view->residual.cast<float>());
    data.scores.emplace_back(view->u.transpose() * data.residuals.back());
  }
  return data;
}

VectorXd Detector::fitted_signal(Index candidate) const {
  const Block& b = best_block(candidate);
  return library_.columns.middleCols(b.first, b.width) * coefficients(candidate).value;
}

}  // namespace fogbench::model
