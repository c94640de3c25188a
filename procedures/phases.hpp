#pragma once
// A plan's phases, for a person: a step as the procedure has it, a turn of its loop, a procedure
// that it calls. What, how long, how many points.

#include <cstddef>
#include <string>
#include <vector>

#include "procedures/plan.hpp"

namespace fogbench::procedures {

struct Phase {
  std::string says;
  Seconds starts_after{0.0}, estimate{0.0};
  std::size_t steps = 0;
  std::size_t points = 0;
  bool open = false;  ///< and more points on the way to a temperature, as many as it takes
};

std::vector<Phase> phases_of(const Plan& plan);

/// "51 steps, about 3 h 53 min, 19 points and those on the way to a temperature (+)"
std::string summary_text(const Plan& plan);

}  // namespace fogbench::procedures
