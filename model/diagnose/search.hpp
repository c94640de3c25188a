#pragma once
// The forward search of a diagnosis: test, name, add, test again, until nothing that is left is
// more than noise; after each addition every added effect is dropped in turn and tested again.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "config/model_file.hpp"
#include "model/diagnose/detector.hpp"
#include "model/gls.hpp"
#include "model/signals.hpp"

namespace fogbench::model {

/// Another explanation that the data cannot exclude.
struct Rival {
  std::string effect;
  double probability = 0.0;
};

/// An effect that the data warrant.
struct Found {
  const Effect* effect = nullptr;
  std::vector<double> inner;
  /// Further values of the inner parameter whose columns the effect takes too: a real loop bends
  /// where one play operator does not, and its rest is no second effect.
  std::vector<double> more_inner;
  double p_value = 1.0;
  double probability = 1.0;      ///< against its rivals
  std::vector<Rival> rivals;     ///< most probable first
  std::string or_shape;          ///< a shadow that cannot be excluded either
  bool inner_at_edge = false;
};

/// What the data say of an effect that was not found.
struct Bound {
  std::string effect;
  double absent_or_below = 0.0;  ///< |coefficient|, 95 %
  std::string unit;
};

struct SearchResult {
  std::vector<Found> found;      ///< in the order found
  std::vector<double> p_of_step; ///< global p-value of each step, the refused last one included
  /// A shape from outside the catalogue that explains the data better than any effect, to a degree
  /// that the effect's own world could not produce; empty when there is none.
  std::string outside_shape;
  double p_outside = 1.0;
  std::vector<NotTestable> not_testable;
  std::vector<Bound> bounds;
};

/// What is searched. `base` holds the model's own columns (with the tangents of its inner
/// parameters); y is the observable less the terms that are held.
struct SearchInput {
  const Signals& signals;
  const NoiseShapes& shapes;
  const config::ModelFile& model;
  Eigen::MatrixXd base;
  Eigen::VectorXd y;
};

struct SearchOptions {
  double false_alarm_rate = 0.05;   ///< of the first step
  double later_false_alarm_rate = 0.01;
  std::size_t most_effects = 5;
  std::uint64_t seed = 20260101;
};

SearchResult search(const SearchInput& input, const SearchOptions& options);

/// The columns that a found effect adds to the base: its regressor and the inner parameter's
/// tangent.
Eigen::MatrixXd columns_of(const Found& found, const Signals& signals);

/// Columns that the others do not already span; keeps the order.
Eigen::MatrixXd full_rank(const Eigen::MatrixXd& columns);

}  // namespace fogbench::model
