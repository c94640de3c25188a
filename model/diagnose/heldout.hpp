#pragma once

#include <Eigen/Core>
#include <vector>

#include "config/model_file.hpp"
#include "model/noise/noise.hpp"
#include "model/table/table.hpp"

namespace fogbench::model {

/// RMS of predictions of rows that took no part in the fit, in the observable's unit: eight blocks
/// of neighbouring rows are left out in turn, the coefficients fitted to the others (inner
/// parameters as `fitted` has them, weighted by the white part of `noise`), and the block predicted
/// by the model alone, without interpolating the noise. Rows of which the others tell less than
/// they do themselves do not count (a warm-up's first ones); how memories began (Effect::starts)
/// all rows tell. NaN when the rows do not suffice. `windows`: of the table's rows that have a
/// measurement, which are in order and complete; the others are there for their history.
double heldout_rms(const Table& table, const Windows& windows, const config::ModelFile& fitted,
                   const NoiseCoefficients& noise);

/// The same for columns: the rows of `x` and `y` are the first of `windows`; those from
/// `bench_rows` on (a static record) are never left out.
double heldout_rms(const Windows& windows, const NoiseCoefficients& noise, const Eigen::MatrixXd& x,
                   const Eigen::VectorXd& y, Eigen::Index bench_rows);

/// RMS residual of least squares on the columns of `fitted`, its inner parameters as they are: it
/// never rises with a term more. NaN when the model cannot be evaluated.
double least_squares_rms(const Table& table, const config::ModelFile& fitted);

/// Whether blocks of rows that took no part in the fit are predicted better with some columns than
/// without them.
struct HeldoutVote {
  /// Fall of the weighted sum of squares of what the other rows, their noise included, do not
  /// predict: what independent unit errors would add up to.
  double gain = 0.0;
  int better = 0;  ///< of `folds`
  int folds = 0;   ///< in which the other rows show the columns at all
};

/// One vote for each of `without`, the columns of a smaller model; `with` are those of the full
/// one. Rows from `bench_rows` on (a static record) are never left out. Empty when the noise is not
/// known.
std::vector<HeldoutVote> heldout_votes(const Windows& windows, const NoiseCoefficients& noise,
                                       const Eigen::MatrixXd& with,
                                       const std::vector<Eigen::MatrixXd>& without,
                                       const Eigen::VectorXd& y, Eigen::Index bench_rows);

}  // namespace fogbench::model
