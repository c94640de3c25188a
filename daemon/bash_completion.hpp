#pragma once
// A program's shell completion, made from the options that it declares.

#include <CLI/CLI.hpp>
#include <string>

namespace fogbench::daemon {

/// For bash. Commands, options, the values of those that have a choice, the names of ready files,
/// and what `fogbench --words KIND` prints: effects, runs, parameters of the procedure on the line.
std::string bash_completion(const CLI::App& app);

}  // namespace fogbench::daemon
