#pragma once
// What was wrong with a command line, as one line that offers what was probably meant.

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace fogbench::daemon {

/// An unknown command or option of `arguments` (without the program's name) with the nearest known
/// one, else what the parser said. The parser itself complains of what is missing first, and of
/// several unknown words in reverse.
std::string mistyped(const CLI::App& app, const std::vector<std::string>& arguments,
                     const CLI::ParseError& error);

}  // namespace fogbench::daemon
