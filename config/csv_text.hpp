#pragma once

#include <string>
#include <string_view>

namespace fogbench::config {

/// A field of a CSV file (RFC 4180), quoted only where the text would not come back as it is:
/// separators, quotes, line breaks, blanks at its ends.
inline std::string csv_text(std::string_view text) {
  constexpr std::string_view kSpecial("\0,\"\r\n", 5);
  const bool plain = text.find_first_of(kSpecial) == std::string_view::npos &&
                     (text.empty() || (text.front() != ' ' && text.back() != ' '));
  if (plain) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += c;
    quoted += c;
  }
  return quoted + '"';
}

}  // namespace fogbench::config
