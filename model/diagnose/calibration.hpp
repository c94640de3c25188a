#pragma once
// From raw Lambdas to one scale and a p-value: each candidate against its own noise quantile, the
// best of all against the best of all in noise alone.

#include <Eigen/Core>
#include <vector>

namespace fogbench::model {

class Calibration {
 public:
  /// candidates x draws, as Detector::lambdas gives them.
  explicit Calibration(const Eigen::MatrixXd& null) { add(null); }
  /// More draws of the same candidates.
  void add(const Eigen::MatrixXd& null);

  /// Lambda less the candidate's own 95 % noise quantile.
  Eigen::VectorXd lead(const Eigen::VectorXd& lambda) const { return lambda - quantile_; }
  Eigen::MatrixXd lead(const Eigen::MatrixXd& lambda) const { return lambda.colwise() - quantile_; }
  /// P(best lead of `among` in noise >= lead), with a shifted exponential beyond the draws.
  double p_value(double lead, const std::vector<Eigen::Index>& among) const;

 private:
  Eigen::MatrixXd null_;
  Eigen::VectorXd quantile_;
};

}  // namespace fogbench::model
