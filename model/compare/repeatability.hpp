#pragma once
// What changed between runs of one test: the coefficients of two runs against each other.
//
//   repeat: a and b are the same vector;  chi2_R = (b - a)'(Ca + Cb)^-1 (b - a)
//   scale:  b is s times a;               chi2_S = min over s of
//                                           (b - s a)'(Cb + s^2 Ca)^-1 (b - s a)
// Where no noise is known, one unknown sigma is taken to be common to all coefficients of both
// runs, and the scatter that is left under the better of the two hypotheses estimates it.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "model/compare/compare.hpp"

namespace fogbench::model {

/// The coefficients of one run, in one unit.
struct RunCoefficients {
  std::string run;
  Eigen::VectorXd values;
  Eigen::MatrixXd covariance;  ///< empty when no noise is known
  std::string word = "run";    ///< what `run` is: "run" or "test"
};

/// Preconditions: both have as many values as names, at least two; both covariances or none.
RunChange change_between(const RunCoefficients& a, const RunCoefficients& b,
                         const std::vector<std::string>& names, const std::string& unit);

/// Which coefficients the runs together cannot tell from zero, judged by their scatter between the
/// runs: for tables that state no noise. One sentence for each coefficient, after one that states
/// the yardstick. Precondition: at least two runs without covariance.
std::vector<std::string> judge_by_scatter(const std::vector<RunCoefficients>& runs,
                                          const std::vector<std::string>& names,
                                          const std::string& unit);

}  // namespace fogbench::model
