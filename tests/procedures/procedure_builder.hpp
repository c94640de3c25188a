#pragma once
// Procedures made by hand, as their files would say them.

#include <string>
#include <utility>
#include <vector>

#include "config/procedure.hpp"

namespace fogbench::procedures::test {

/// Steps get the pointers that a file's would.
inline config::ProcedureConfig procedure(const std::string& name, std::vector<config::Step> steps) {
  config::ProcedureConfig made;
  made.name = name;
  made.file = name + ".json";
  made.steps = std::move(steps);
  for (std::size_t i = 0; i < made.steps.size(); ++i) {
    made.steps[i].pointer = "/steps/" + std::to_string(i);
  }
  return made;
}

inline config::Step step(decltype(config::Step::action) action) {
  return {std::move(action), ""};
}

/// The paper's levels: 0 ... 300 ... -300 ... 0 uT by 50.
inline std::vector<double> paper_levels() {
  std::vector<double> levels;
  for (int ut = 0; ut <= 300; ut += 50) levels.push_back(ut);
  for (int ut = 250; ut >= -300; ut -= 50) levels.push_back(ut);
  for (int ut = -250; ut <= 0; ut += 50) levels.push_back(ut);
  return levels;
}

}  // namespace fogbench::procedures::test
