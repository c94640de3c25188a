#pragma once
// Small tools on columns that the libraries share: which signals move, what they look like scaled,
// in which direction they go.

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "model/table/signals.hpp"

namespace fogbench::model {

/// A signal that takes at least three values, missing entries as its mean.
struct MovingSignal {
  std::string name;
  Eigen::VectorXd value;   ///< as in the table
  Eigen::VectorXd scaled;  ///< to -1 ... 1
  double minimum = 0.0, maximum = 0.0;
  double span() const { return maximum - minimum; }
};

/// In the signal's unit: a span below it is an instrument's noise, not an excitation.
double least_excitation(std::string_view name);

/// Empty when the signal is absent, constant, or moves by less than `least` over the table.
std::optional<MovingSignal> moving_signal(const Signals& signals, std::string_view name,
                                          double least = 0.0);

/// Every signal of the measurement table that moves: temperature, its rate and gradient, heater,
/// ambient, the three fields, azimuth, and time since the run's start.
std::vector<MovingSignal> moving_signals(const Signals& signals);

/// +1 while the signal rises, -1 while it falls, kept where it stands still; within runs.
Eigen::VectorXd direction(const Signals& signals, const Eigen::VectorXd& value);

/// Legendre polynomials P_1 ... P_degree of x in -1 ... 1, one a column.
Eigen::MatrixXd legendre(const Eigen::VectorXd& x, int degree);

}  // namespace fogbench::model
