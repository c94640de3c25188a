#pragma once
// What the standard errors that a table states row by row say of its white noise: one size of it,
// and by how much each row's variance differs from that.

#include <Eigen/Core>

#include "model/noise/noise.hpp"

namespace fogbench::model {

/// N in deg/sqrt(h): the root of the median of error^2 x duration; 0 where none is stated.
double stated_white(const Windows& windows);

/// Each row's white variance over N^2/duration, 1 for the usual row and for one that states
/// nothing. Errors that were estimated from few samples scatter by themselves: what neighbouring
/// rows differ by at random is taken off, so that of errors that only scatter nothing is left but
/// their median.
Eigen::VectorXd stated_white_scale(const Windows& windows);

}  // namespace fogbench::model
