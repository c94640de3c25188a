#pragma once
// What `fogbench verdict` and `fogbench passport` share: which runs, against which limits.

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "acceptance/passport.hpp"
#include "config/result.hpp"

namespace fogbench::cli {

struct PassportOptions {
  std::vector<std::string> runs;
  std::string limits = "acceptance";
  std::string model;  ///< empty: the ready one of what each test excited
  std::string store;
  bool unfinished = false;
};

void add_passport_options(CLI::App& command, PassportOptions& options);

/// Reads the runs and judges them. Errors: kUsage, kBadInput, kStore.
Result<acceptance::Passport> judge_runs(const PassportOptions& options);

}  // namespace fogbench::cli
