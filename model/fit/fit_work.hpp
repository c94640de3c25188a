#pragma once
// A fit under way, shared by the two halves of fit(): finding the solution (fit.cpp) and reporting
// it (fit_results.cpp).

#include <Eigen/Core>
#include <limits>

#include "model/fit/fit.hpp"
#include "model/fit/observations.hpp"

namespace fogbench::model {

/// One fit under way: the system, and what has been found so far.
struct FitWork {
  const Table& table;
  const config::ModelFile& model;
  const FitOptions& options;
  const Signals& signals;
  const Design& design;
  Observations& observations;
  FitResult result;
  Eigen::VectorXd inner;
  Eigen::VectorXd beta;        ///< of the free columns, the starts' after the model's own
  Eigen::MatrixXd covariance;  ///< of [free columns, inner], NaN where not determined
  Eigen::VectorXd
      variance_at_inner;  ///< of the free columns, the inner parameters held; may be empty
  double coverage = 2.0;  ///< factor of the expanded uncertainty

  Eigen::Index free() const { return static_cast<Eigen::Index>(design.free_columns().size()); }
  Eigen::Index unknowns() const { return free() + inner.size(); }
};

/// X, T = dy/da at the current solution, and y, from rows [X D y] of the observations.
struct Linearised {
  Eigen::MatrixXd x;
  Eigen::VectorXd y;
};
Linearised linearise(const FitWork& work, const Eigen::MatrixXd& rows);

/// Single rows that the rest of them contradicts.
std::vector<LeftOut> find_left_out(const FitWork& work);
/// What an unknown lag of the thermometer may do is added to the covariance, and said where that
/// matters; nothing where temperature_start_c tells that the temperatures were freed of it.
/// Precondition: coloured noise.
void allow_for_lag(FitWork& work);
/// Predicted values, residuals and their size; needs degrees_of_freedom.
void fill_residuals(FitWork& work);
/// Independent noise: sigma is estimated, as a whole or as a factor on the weights.
void fill_independent_noise(FitWork& work);
/// Coloured noise on the rows themselves. Where windows were joined, a row's own white noise comes
/// on top of its window's deviation, and no correlation is removed.
Status fill_coloured_noise(FitWork& work);
/// Estimates with their uncertainty, and warnings of inner parameters that are not identified.
void fill_estimates(FitWork& work);
void warn_of_correlation(FitResult& result);
/// Of an exact fit, and of coefficients whose uncertainty exceeds themselves and, for one unit of
/// their term, anything that was measured.
void warn_of_little_evidence(FitResult& result);
/// The model file with the results in it; terms that were left out whole are not in it.
config::ModelFile fitted_model(const FitWork& work);

}  // namespace fogbench::model
