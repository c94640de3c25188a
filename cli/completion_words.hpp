#pragma once
// What shell completion asks the program itself: fogbench --words KIND WORD... prints the words of
// that kind, one a line, knowing those typed so far.

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

namespace fogbench::cli {

/// effects, topics (of help), runs, parameters (of the procedure among `arguments`, for --set).
/// Nothing when this is not what `arguments` ask. What cannot be read has no words.
std::optional<std::vector<std::string>> asked_words(const CLI::App& app,
                                                    const std::vector<std::string>& arguments);

}  // namespace fogbench::cli
