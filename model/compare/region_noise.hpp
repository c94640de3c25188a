#pragma once
// What noise alone does to the mean residuals of regions: their covariance after whatever was
// fitted has been projected out, and how large the largest of them gets.

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "config/result.hpp"
#include "model/compare/partition.hpp"
#include "model/compare/region_score.hpp"
#include "model/fit/fit.hpp"
#include "model/noise/plausible_noise.hpp"

namespace fogbench::model {

class RegionNoise {
 public:
  /// The noise is the fit's: coloured, or independent of a size that its residual gives. A model
  /// that was held has no residual to take it from (a miss must not pass for noise): there it is
  /// the coloured noise of the same terms set free, else what a column states (the weights, the
  /// standard errors, the scatter sigma_deg_per_h), else what the free terms leave.
  static Result<RegionNoise> make(const Table& table, const FitOptions& options,
                                  const FitResult& fit, const std::vector<Partition>& partitions);

  bool known() const { return known_; }
  /// RMS residual that noise alone leaves; where its size comes from the residual, that size.
  const NoiseFloor& floor() const { return floor_; }
  bool size_from_residual() const { return degrees_ < std::numeric_limits<double>::infinity(); }
  const std::string& says() const { return says_; }
  /// Of each region's mean residual; 0 where the fit leaves it no freedom.
  Eigen::VectorXd standard_errors() const;
  /// How far each region's mean residual is from what noise makes it, and the chance that noise
  /// takes the largest |z| of all regions as far. Under coloured noise on up to 1,000 windows z is
  /// that of region_score.hpp, else the mean residual over its standard error.
  RegionScores scores(const Eigen::VectorXd& mean_residual, std::uint64_t seed) const;

 private:
  RegionNoise() = default;
  Status coloured(const Table& table, const FitOptions& options, const FitResult& fit,
                  const std::vector<Partition>& partitions);
  Status independent(const Table& table, const FitResult& fit,
                     const std::vector<Partition>& partitions, const Eigen::VectorXd& deviation,
                     bool project);
  void set_counts(const std::vector<Partition>& partitions);
  Eigen::VectorXd family_wise(const Eigen::VectorXd& z, std::uint64_t seed) const;

  bool known_ = false;
  NoiseFloor floor_;
  /// Degrees of freedom that the noise's size was estimated from; infinite when it was stated.
  double degrees_ = 0.0;
  bool held_ = false;  ///< nothing was fitted away
  std::string says_;
  Eigen::VectorXd counts_;      ///< rows of each region
  Eigen::MatrixXd covariance_;  ///< of the mean residuals
  /// For region_score.hpp; no shapes: not used.
  std::optional<NoiseShapes> shapes_;
  Eigen::MatrixXd fitted_columns_, indicators_;
  Eigen::VectorXd window_residual_;
};

/// A fitted model's regressors and the derivatives by its inner parameters, on the fitted rows, one
/// column for each estimate that is not held, from differences of predict(). `column` numbers the
/// estimates that are not held.
Result<Eigen::VectorXd> tangent(const Table& table, const FitResult& fit, Eigen::Index column);

}  // namespace fogbench::model
