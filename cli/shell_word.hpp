#pragma once

#include <string>

namespace fogbench::cli {

/// One word of a command as a shell takes it: in quotes where it needs them.
std::string shell_word(const std::string& word);

}  // namespace fogbench::cli
