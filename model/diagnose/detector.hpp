#pragma once
// One forward step of a diagnosis: how much better does each candidate explain the data, when the
// noise is estimated anew with every candidate, and how often would noise alone do as well?
//
//   l_k(q) = log prior_k - log|L_k| - log|R_k| + log evidence(q)       noise shape k, N integrated
//   Lambda_c = 2 max_a [ log sum_k exp l_k(q_k - |u_kc(a)' e_k|^2) - log sum_k exp l_k(q_k) ]
//
// e_k is the residual whitened under shape k and cleared of the base columns, q_k = |e_k|^2, u_kc
// an orthonormal basis of the candidate's columns treated alike. Draws from the posterior of the
// noise (not from one plugged-in estimate) calibrate Lambda; only the scores U'E are needed for
// them, so the cost of a draw does not depend on how a candidate was made.

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "model/diagnose/whitened_library.hpp"
#include "model/fit/gls.hpp"

namespace fogbench::model {

/// Data made of noise, whitened under every kept shape: what candidates are calibrated on.
struct Draws {
  std::vector<Eigen::MatrixXf> residuals;  ///< per kept shape, rows x draws, base projected out
  /// Per kept shape, library columns x draws; of the first columns, as far as they were asked for.
  std::vector<Eigen::MatrixXf> scores;
  Eigen::Index count = 0;
};

class Detector {
 public:
  /// All arguments must outlive the detector. base: rows x p, full rank.
  Detector(const WhitenedLibrary& whitened, const Eigen::MatrixXd& base, const Eigen::VectorXd& y);

  Eigen::Index candidates() const { return static_cast<Eigen::Index>(library_.candidates.size()); }
  /// Lambda of each candidate on the data; -1 where it is not testable.
  const Eigen::VectorXd& observed() const { return observed_; }
  /// The best point of the candidate's grid.
  const Block& best_block(Eigen::Index candidate) const;
  /// Not so when every block projects to nothing beside this base.
  bool testable(Eigen::Index candidate) const;
  /// Lambda of any columns (not of the library).
  double lambda_of(const Eigen::MatrixXd& columns) const;

  enum class Among { kAll, kEffects };
  /// Noise drawn from its posterior given the base, or given the base and a candidate's best block.
  Draws draw(Eigen::Index count, std::uint64_t seed, Eigen::Index with_candidate = -1,
             Among among = Among::kAll) const;
  /// Adds the scores of further candidates to draws that have those of the effects alone.
  void score(Draws& draws, Among among) const;
  /// candidates x draws, -1 where a candidate is not testable or not among those wanted; `signal`
  /// (rows) is added to every draw where it is not empty. The draws are scored for those wanted.
  Eigen::MatrixXd lambdas(const Draws& draws, const Eigen::VectorXd& signal = {},
                          Among among = Among::kAll) const;
  /// What the candidate's best block contributes to the data, fitted: rows.
  Eigen::VectorXd fitted_signal(Eigen::Index candidate) const;
  /// The noise shape that suits the candidate's best block best, by its number.
  std::size_t best_view(Eigen::Index candidate) const;
  struct Coefficients {
    Eigen::VectorXd value;
    Eigen::VectorXd standard_error;
  };
  /// Of the candidate's best block, under the noise that suits it best.
  Coefficients coefficients(Eigen::Index candidate) const;
  /// Like lambdas, but with the noise held at its null posterior: for wide bases, which would pass
  /// structure off as noise.
  Eigen::MatrixXd lambdas_at_null_noise(const Draws& draws) const;
  Eigen::VectorXd observed_at_null_noise() const;
  /// Portmanteau statistic of each draw's innovations, the noise weighed anew in each: large where
  /// no noise of the family leaves them white.
  Eigen::VectorXd whiteness(const Draws& draws) const;
  double observed_whiteness() const;

 private:
  struct View;  // one noise shape
  /// A point of a candidate's grid that may be its best.
  struct Contender {
    Eigen::Index candidate;
    const Block* block;
  };
  /// The points of a candidate's grid of which the base leaves something.
  struct Living {
    Eigen::Index candidate;
    std::vector<const Block*> blocks;
  };
  /// Those that are best under at least one noise shape: the best on the whole is one of them, or
  /// next to it. `gain` per noise shape and column.
  std::vector<Contender> contenders_of(const std::vector<Eigen::ArrayXf>& gain, Among among) const;
  /// lambdas(); for a single draw, also the index of each candidate's best block.
  Eigen::MatrixXd scan(const Draws& draws, const Eigen::VectorXd& signal, Among among,
                       std::vector<std::size_t>* best_block) const;
  Draws data_as_draw() const;

  const NoiseShapes& shapes_;
  const Eigen::MatrixXd& base_;
  const Library& library_;
  const Eigen::VectorXd& y_;
  double nu_;
  ResidualEvidence evidence_;
  std::vector<std::shared_ptr<const View>> views_;
  std::vector<Living> living_;
  Eigen::VectorXd observed_;
  std::vector<std::size_t> best_block_;
};

}  // namespace fogbench::model
