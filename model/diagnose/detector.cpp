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
#include <set>
#include <thread>
#include <utility>

#include "model/fit/kernels.hpp"
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
constexpr double kLeastSquares = 1e-24;  // deg^2/h: keeps a perfect fit finite
// Of the portmanteau statistic.
constexpr Index kMostLags = 20;
constexpr Index kRowsALag = 5;
// Shapes that weigh less in a draw do not move its statistic.
constexpr double kLeastShareOfDraw = 0.01;
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

float sum_of(const Eigen::ArrayXf& gain, const Block& block) {
  return block.width == 1 ? gain[block.first] : gain.segment(block.first, block.width).sum();
}

/// Ljung and Box: n (n + 2) sum over the lags of r^2 / (n - lag), of positive correlations alone.
/// Neighbours that differ too much share a rounded angle (quantisation noise of IEEE 952): that
/// hides nothing, and makes what is said of the rest cautious.
double portmanteau(const Eigen::Ref<const Eigen::VectorXf>& e) {
  const Index n = e.size(), lags = std::min(kMostLags, n / kRowsALag);
  const double squares = std::max(static_cast<double>(e.squaredNorm()), kLeastSquares);
  double sum = 0.0;
  for (Index lag = 1; lag <= lags; ++lag) {
    const double r = static_cast<double>(e.head(n - lag).dot(e.tail(n - lag))) / squares;
    if (r > 0.0) sum += r * r / static_cast<double>(n - lag);
  }
  return static_cast<double>(n) * static_cast<double>(n + 2) * sum;
}

}  // namespace

/// One noise shape's view of the data and of the library.
struct Detector::View {
  std::shared_ptr<const Whitener> whitener;
  MatrixXd q;               // basis of the whitened base
  MatrixXf u;               // candidates' columns: whitened, projected, orthonormal within a block
  std::vector<bool> alive;  // per block, in the library's order
  VectorXd residual;
  double squares = 0.0;
  double log_prior = 0.0;

  MatrixXd project(MatrixXd whitened) const {
    kernels().project(q.data(), q.rows(), q.cols(), whitened.data(), whitened.cols());
    return whitened;
  }
};

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

  // Most noise shapes are too unlikely to matter, with each candidate as without: a sample of the
  // candidates tells, and on a finer grid those that led on the coarse one.
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
  std::vector<std::size_t> likely;
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (merit[k] > std::log(kLeastShape) - kUnsampled) likely.push_back(k);
  }
  std::sort(likely.begin(), likely.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(-merit[a], a) < std::pair(-merit[b], b);
  });
  if (likely.size() > kMostShapes) likely.resize(kMostShapes);
  in_parallel(likely.size(), [&](std::size_t i) {
    const std::size_t k = likely[i];
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
  for (const std::size_t k : likely) {
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

Draws Detector::draw(Index count, std::uint64_t seed, Index with_candidate, Among among) const {
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
  });
  score(draws, among);
  return draws;
}

void Detector::score(Draws& draws, Among among) const {
  const Index columns = library_.columns_of(among == Among::kEffects);
  in_parallel(views_.size(), [&](std::size_t v) {
    const MatrixXf &u = views_[v]->u, &residuals = draws.residuals[v];
    MatrixXf& scores = draws.scores[v];
    const Index first = scores.rows();
    if (first >= columns) return;
    MatrixXf more(columns - first, draws.count);
    kernels().scores(u.col(first).data(), residuals.data(), u.rows(), more.rows(), draws.count,
                     more.data());
    if (first == 0) {
      scores = std::move(more);
    } else {
      scores.conservativeResize(columns, draws.count);
      scores.bottomRows(more.rows()) = more;
    }
  });
}

MatrixXd Detector::lambdas(const Draws& draws, const VectorXd& signal, Among among) const {
  return scan(draws, signal, among, nullptr);
}

MatrixXd Detector::scan(const Draws& draws, const VectorXd& signal, Among among,
                        std::vector<std::size_t>* best_block) const {
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
    shift[v] = views_[v]->u.leftCols(draws.scores[v].rows()).transpose() * s.cast<float>();
  }
  MatrixXd out = MatrixXd::Constant(candidates(), draws.count, -1.0);
  in_parallel(static_cast<std::size_t>(draws.count), [&](std::size_t draw) {
    const auto b = static_cast<Index>(draw);
    VectorXd base(n_views);
    std::vector<Eigen::ArrayXf> gain(views_.size());  // of each column
    for (std::size_t v = 0; v < views_.size(); ++v) {
      const auto k = static_cast<Index>(v);
      squares(k, b) = std::max(squares(k, b), kLeastSquares);
      base[k] = views_[v]->log_prior + evidence_(squares(k, b));
      gain[v] = draws.scores[v].col(b);
      if (shift[v].size() > 0) gain[v] += shift[v].array();
      gain[v] = gain[v].square();
    }
    const std::vector<Contender> contenders = contenders_of(gain, among);
    const auto count = static_cast<Index>(contenders.size());
    Eigen::ArrayXXf with(count, n_views);
    for (Index v = 0; v < n_views; ++v) {
      for (Index i = 0; i < count; ++i) {
        const Block& block = *contenders[static_cast<std::size_t>(i)].block;
        with(i, v) = sum_of(gain[static_cast<std::size_t>(v)], block);
      }
      // Beyond this share of the squares single precision ends.
      constexpr float kMostExplained = 1.0f - 1e-6f;
      const auto q = static_cast<float>(squares(v, b));
      with.col(v) = (1.0f - (with.col(v) / q).min(kMostExplained)).log();
      evidence_.change(squares(v, b), with.col(v));
    }
    // log sum exp over the views, both relative to the best view without any candidate.
    const Eigen::ArrayXf relative = (base.array() - base.maxCoeff()).cast<float>();
    with.rowwise() += relative.transpose();
    const Eigen::ArrayXf most = with.rowwise().maxCoeff();
    const Eigen::ArrayXf gained = most + (with.colwise() - most).exp().rowwise().sum().log();
    const float null = std::log(relative.exp().sum());
    for (Index i = 0; i < count; ++i) {
      const Contender& contender = contenders[static_cast<std::size_t>(i)];
      const double lambda = 2.0 * static_cast<double>(gained[i] - null);
      double& best = out(contender.candidate, b);
      if (lambda <= best) continue;
      best = lambda;
      if (best_block != nullptr) {
        const auto c = static_cast<std::size_t>(contender.candidate);
        (*best_block)[c] =
            static_cast<std::size_t>(contender.block - library_.candidates[c].blocks.data());
      }
    }
  });
  return out;
}

std::vector<Detector::Contender> Detector::contenders_of(const std::vector<Eigen::ArrayXf>& gain,
                                                         Among among) const {
  std::vector<Contender> out;
  for (const Living& living : living_) {
    const Candidate& candidate = library_.candidates[static_cast<std::size_t>(living.candidate)];
    if (among == Among::kEffects && candidate.shadow()) continue;
    const std::size_t own = out.size();
    for (const Eigen::ArrayXf& of_view : gain) {
      const Block* best = nullptr;
      float most = -1.0f;
      for (const Block* block : living.blocks) {
        const float its = sum_of(of_view, *block);
        best = its > most ? block : best;
        most = std::max(most, its);
      }
      const auto same = [best](const Contender& other) { return other.block == best; };
      if (std::none_of(out.begin() + static_cast<std::ptrdiff_t>(own), out.end(), same)) {
        out.push_back({living.candidate, best});
      }
    }
  }
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

VectorXd Detector::whiteness(const Draws& draws) const {
  VectorXd out = VectorXd::Zero(draws.count);
  in_parallel(static_cast<std::size_t>(draws.count), [&](std::size_t draw) {
    const auto b = static_cast<Index>(draw);
    std::vector<double> weight(views_.size());
    for (std::size_t v = 0; v < views_.size(); ++v) {
      const double squares = static_cast<double>(draws.residuals[v].col(b).squaredNorm());
      weight[v] = views_[v]->log_prior + evidence_(std::max(squares, kLeastSquares));
    }
    const double total = log_sum_exp(weight);
    for (std::size_t v = 0; v < views_.size(); ++v) {
      const double share = std::exp(weight[v] - total);
      if (share > kLeastShareOfDraw) out[b] += share * portmanteau(draws.residuals[v].col(b));
    }
  });
  return out;
}

double Detector::observed_whiteness() const {
  return whiteness(data_as_draw())[0];
}

}  // namespace fogbench::model
