#pragma once
// Two measurements against each other: `fogbench compare RUN RUN`.

#include <string>

#include "cli/load_table.hpp"
#include "config/exit_status.hpp"
#include "config/result.hpp"

namespace fogbench::cli {

struct PairOptions {
  DataOptions data;   ///< two
  std::string model;  ///< empty: the ready one of what they excited
  std::string weight_by, noise, report;
  bool check = false, json = false;
};

/// kNo with `check` when they differ by more than noise explains.
Result<ExitStatus> compare_pair(const PairOptions& options);

}  // namespace fogbench::cli
