#pragma once
// One state of the search: a base, how well every candidate does beside it, and what noise alone
// would make of that.

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "model/diagnose/calibration.hpp"
#include "model/diagnose/search.hpp"

namespace fogbench::model {

class Stage {
 public:
  /// The input must outlive the stage.
  Stage(const SearchInput& input, Eigen::MatrixXd base, std::uint64_t seed);

  const Detector& detector() const { return detector_; }
  const Candidate& candidate(Eigen::Index c) const {
    return input_.tried().candidates[static_cast<std::size_t>(c)];
  }
  /// Testable effects and shadows.
  const std::vector<Eigen::Index>& effects() const { return effects_; }
  const std::vector<Eigen::Index>& shadows() const { return shadows_; }
  /// Of each candidate: its Lambda less its own noise quantile.
  const Eigen::VectorXd& lead() const { return lead_; }
  /// The one of `among` that leads; precondition: not empty.
  Eigen::Index best(const std::vector<Eigen::Index>& among) const;
  /// The effect to name: the one that leads among those that stand, unless it does so only in the
  /// limit where it is a simpler one that does nearly as well (a lag of next to nothing, a
  /// saturation that does not bend). Those refused are passed over. Precondition: not all effects
  /// are refused.
  Eigen::Index leader(const std::vector<std::size_t>& refused) const;
  /// The data show the effect itself, and not only how its memory may have begun: a coefficient of
  /// its own is larger than its expanded uncertainty, and no beginning larger than it allows.
  bool stands(Eigen::Index c) const;
  /// Global p-value of the lead among all effects, or among all shadows.
  double p_value(Eigen::Index c) const {
    return calibration_.p_value(lead_[c], candidate(c).shadow() ? shadows_ : effects_);
  }
  /// The same of one candidate by itself.
  double p_value_alone(Eigen::Index c) const { return calibration_.p_value(lead_[c], {c}); }
  /// P(one of `others` is ahead of `world` by at least `lag`, where `world` as fitted is the
  /// truth).
  double plausible(Eigen::Index world, double lag, const std::vector<Eigen::Index>& others);
  /// The best point of the candidate's inner parameter, by golden section between grid points.
  double refined(Eigen::Index c) const;
  /// The best point of the candidate's grid is an end of it.
  bool at_edge(Eigen::Index c) const;
  /// The data push it beyond its grid: an end explains them better than what lies within, by more
  /// than one parameter gains by chance.
  bool beyond_range(Eigen::Index c) const;
  std::vector<Bound> bounds() const;

 private:
  /// Noise as it is where a candidate is the truth: drawn beside it, or beside another one that the
  /// same noise shape suits best.
  struct Noise {
    Eigen::Index beside;
    Draws draws;
  };
  /// Scored for those wanted.
  const Noise& noise_of(Eigen::Index world, Detector::Among among);
  /// More draws may change what the lead of the best of these means.
  bool is_open(const std::vector<Eigen::Index>& among) const;
  /// How much larger it must be where `world` is the truth: by what the other one explains more,
  /// and for the parameters fitted.
  double larger_noise(Eigen::Index world, const Noise& noise) const;

  const SearchInput& input_;
  Eigen::MatrixXd base_;
  std::uint64_t seed_;
  Detector detector_;
  Calibration calibration_;
  Eigen::VectorXd lead_;
  std::vector<Eigen::Index> effects_, shadows_;
  std::map<std::size_t, Noise> noise_;  ///< by noise shape, drawn when first needed
};

}  // namespace fogbench::model
