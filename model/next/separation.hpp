#pragma once
// How well a measurement tells effects apart, before it is made.
//
//   s^2(a, b) = min over beta, inner_b of |L^-1 (g_a beta_a - [X, g_b] beta)|^2
//
// over the rows that are there already and those of the measurement to come, which are independent
// runs: the rival has to explain both with the same coefficients, and only the bias of the new run
// is its own. What moves in the new run and never did before brings errors that the model cannot
// know yet: first and second order of such a signal are cleared away too. Every column is whitened
// and cleared of X once; then all pairs follow from one Gram matrix G = Z'Z of what is left:
//
//   s^2 = beta_a' G_aa beta_a - c' G_bb^-1 c,  c = G_ba beta_a

#include <Eigen/Core>
#include <string_view>
#include <vector>

#include "config/model_file.hpp"
#include "model/effects/effect.hpp"
#include "model/next/bench_schedule.hpp"

namespace fogbench::model {

/// An effect at one value of its inner parameter: `width` neighbouring columns of the Gram matrix.
struct GramBlock {
  Eigen::Index first = 0;
  Eigen::Index width = 1;
  std::vector<double> inner;
  /// A jump happens once: the new run does not hold it. Jumps stand in the matrix both ways, since
  /// nobody knows whether what jumped will jump again at the same time after power-on.
  bool once = false;
};

/// An effect that takes part, with all the values of its inner parameter that are weighed.
struct Member {
  const Effect* effect = nullptr;
  std::vector<GramBlock> blocks;
};

/// What is supposed to be true: a block of columns and their coefficients.
struct Truth {
  std::size_t block = 0;
  Eigen::VectorXd beta;
};

class Separation {
 public:
  /// `fitted` gives X: its terms but those of the members, at their inner parameters. The first
  /// values of a member's inner grid are those of `inner` (by member; empty: the grid alone).
  /// `present` must have columns for every signal of the members and must outlive the separation.
  Separation(const Recorded& present, const config::ModelFile& fitted,
             const std::vector<const Effect*>& effects,
             const std::vector<std::vector<double>>& inner, const NoiseCoefficients& noise,
             int grid_points);

  const std::vector<Member>& members() const { return members_; }
  /// The Gram matrix of what is there already. Empty when the windows are unusable.
  const Eigen::MatrixXd& present() const { return present_gram_; }
  /// The Gram matrix of that and one more run.
  Eigen::MatrixXd with(const Recorded& more) const;

  /// s^2 of the truth of one member against another member. Zero or more.
  double squared(const Eigen::MatrixXd& gram, std::size_t member, const Truth& truth,
                 std::size_t rival) const;
  /// The rival's coefficients that look most like the truth.
  Truth nearest(const Eigen::MatrixXd& gram, std::size_t member, const Truth& truth,
                std::size_t rival) const;
  /// Of the truth alone, against X.
  double squared(const Eigen::MatrixXd& gram, std::size_t member, const Truth& truth) const;
  /// The regressor on the rows that are there already.
  Eigen::MatrixXd present_columns(std::size_t member, std::size_t block) const;

 private:
  /// [X | members' columns] of a run, neither whitened nor projected.
  Eigen::MatrixXd rows_of(const Recorded& run, bool again) const;
  /// Columns of what moves in `more` and stood still so far.
  Eigen::MatrixXd new_to_the_model(const Recorded& more) const;
  /// Z'Z of rows whose first `base` columns are cleared away.
  Eigen::MatrixXd gram_of(const Eigen::MatrixXd& rows, Eigen::Index base) const;

  const Recorded& present_;
  config::ModelFile base_model_;
  NoiseCoefficients noise_;
  std::vector<Member> members_;
  Eigen::Index base_ = 0, columns_ = 0;
  Eigen::MatrixXd triangle_;  // of the present rows, whitened: all that is needed of them
  Eigen::MatrixXd present_gram_;
};

/// Twice the Kullback-Leibler divergence of one noise from another over `hours` of record, the bias
/// left free: the square of the separation by which a record tells the two noises apart. From 24
/// windows, enough for what differs slowly.
double squared_noise_separation(double hours, const NoiseCoefficients& truth,
                                const NoiseCoefficients& rival);

}  // namespace fogbench::model
