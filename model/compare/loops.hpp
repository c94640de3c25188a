#pragma once
// Passes up and down over a variable, in the order of time: what a plot of a hysteresis loop joins.

#include <string>
#include <string_view>
#include <vector>

#include "model/table/signals.hpp"

namespace fogbench::model {

/// One pass over the variable, upwards or downwards.
struct Branch {
  bool rising = true;
  /// Rows of the table that stand at the same value one after another, stop by stop.
  std::vector<std::vector<std::size_t>> stops;
  /// Begins where the branch before it in the list ends: the same sweep turned round.
  bool continues = false;
};

/// The branches of each run; of a field within each of its sweeps only (the segment before '/'),
/// for other axes move the rest of the time. Empty unless the variable was passed in both
/// directions, each time over about half of its range or more. Precondition:
/// signals.available(variable).
std::vector<Branch> branches_of(const Signals& signals, std::string_view variable);

}  // namespace fogbench::model
