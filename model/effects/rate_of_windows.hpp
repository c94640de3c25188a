#pragma once
// Temperature rates of averaging windows in other ways than the table's own: a logger's rate may be
// averaged differently from how the physics acts.

#include <Eigen/Core>
#include <vector>

#include "model/effects/effect.hpp"

namespace fogbench::model::effects {

/// The effect with the rate of each window taken from the temperatures at its ends, where windows
/// follow each other without a gap. None where the table has no temperature or no time.
std::vector<Shape> with_rate_of_windows(const Effect& own, const Signals& signals);

/// LPF(dT/dt; tau), degC/h: of the table's rates, whose gaps are bridged with the temperatures at
/// the windows' ends.
Eigen::VectorXd lagged_rate(const Signals& signals, double tau_s);
/// The same from the temperature alone, (T - LPF(T)) / tau: no derivative is taken, so it is good
/// between windows too, where a rate of window means is smeared.
Eigen::VectorXd lagged_rate_of_means(const Signals& signals, double tau_s);

/// The median of the windows' durations, at least 1 s.
double usual_duration_s(const Signals& signals);

}  // namespace fogbench::model::effects
