#include "cli/shell_word.hpp"

namespace fogbench::cli {

std::string shell_word(const std::string& word) {
  constexpr const char* kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789%+,-./:=@_#";
  // A '#' begins a comment only at the beginning of a word.
  const bool plain =
      !word.empty() && word.front() != '#' && word.find_first_not_of(kPlain) == std::string::npos;
  if (plain) return word;
  std::string out = "'";
  for (const char c : word) {
    if (c == '\'') {
      out += "'\\''";
    } else {
      out += c;
    }
  }
  return out + "'";
}

}  // namespace fogbench::cli
