// Data made of noise, and how every candidate does on them.

#include <boost/random/chi_squared_distribution.hpp>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_real_distribution.hpp>

#include "model/diagnose/detector_view.hpp"

namespace fogbench::model {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

float sum_of(const Eigen::ArrayXf& gain, const Block& block) {
  return block.width == 1 ? gain[block.first] : gain.segment(block.first, block.width).sum();
}

}  // namespace

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
    const Eigen::MatrixXf &u = views_[v]->u, &residuals = draws.residuals[v];
    draws.scores[v].resize(u.cols(), count);
    kernels().scores(u.data(), residuals.data(), u.rows(), u.cols(), count, draws.scores[v].data());
  });
  return draws;
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
    shift[v] = views_[v]->u.transpose() * s.cast<float>();
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

}  // namespace fogbench::model
