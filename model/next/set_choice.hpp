#pragma once
// One ambiguous set, and the experiments that would tell its members apart.

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "model/next/experiments.hpp"
#include "model/next/next_measurement.hpp"
#include "model/next/separation.hpp"

namespace fogbench::model {

/// Key of the experiment that is the present run once more.
inline constexpr const char* kRepeat = "repeat";
/// Two effects separate at this whitened distance: the set then holds one name.
inline constexpr double kSeparates = 3.6;

/// All arguments of the constructor must outlive the choice.
class SetChoice {
 public:
  SetChoice(const NextMeasurementInput& input, const Recorded& present,
            const std::vector<Experiment>& experiments, const std::vector<std::string>& set);

  /// The best one or two experiments for the whole set, or for each rival of the leader; none where
  /// the set's first member is no effect of the catalogue that stands in the fitted model.
  std::vector<NextMeasurement> choose() const;

 private:
  using Index = Eigen::Index;
  using Pairs = std::vector<std::pair<Index, Index>>;
  /// One experiment, weighed for the set: what it adds to s^2, [truth][rival], the walk last.
  struct Weighed {
    const Experiment* experiment;
    Eigen::MatrixXd squared;
  };
  /// A noise that might have made what looks like an effect.
  struct Walk {
    NoiseCoefficients noise;
    Separation separation;
    double present_squared;  ///< by which the present data tell it from the fitted noise
  };

  bool find_leader();
  void weigh(const std::vector<Experiment>& experiments);
  double mimicking_walk_squared(const Separation& separation) const;
  void find_truths(const Separation& separation);
  Eigen::MatrixXd squared(const Separation& separation, const std::vector<Walk>& walks,
                          const Recorded* more) const;
  bool concerns(const Experiment& experiment) const;
  Pairs pairs_with(Index rival) const;
  Pairs all_pairs() const;
  double least(const Eigen::MatrixXd& squared, const Pairs& pairs) const;
  std::vector<NextMeasurement> best_for(const Pairs& pairs, std::vector<std::string> names) const;
  std::string of_present(const Pairs& pairs) const;

  const NextMeasurementInput& input_;
  const Recorded& present_;
  std::vector<const Effect*> effects_;
  std::vector<std::string> names_;
  bool walk_ = false;
  Truth leader_;
  std::vector<double> leader_inner_;
  std::vector<std::vector<Truth>> truths_;  ///< of each effect; a jump once and again
  Eigen::MatrixXd present_squared_;
  std::vector<Weighed> weighed_;
};

}  // namespace fogbench::model
