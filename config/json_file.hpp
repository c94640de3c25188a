#pragma once
// JSON files as text and as a tree. Stricter than the standard: a key twice in one object, a
// number beyond a double and nesting deeper than any of our files has are errors.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "config/result.hpp"

namespace fogbench::config {

/// The whole file. kBadInput, one line, for a missing, unreadable or oversized one (64 MiB), and
/// for a directory.
Result<std::string> read_text_file(const std::filesystem::path& file);

/// kBadInput with `name`, line and column for a syntax error; with `name` and JSON pointer for a
/// key that stands twice.
Result<nlohmann::json> parse_json(const std::string& text, const std::string& name);

/// Both of the above.
Result<nlohmann::json> read_json_file(const std::filesystem::path& file);

/// JSON text of at most 100 columns where that is possible: what fits on a line stands on one.
/// Numbers have the shortest digits that read back exactly.
std::string pretty_json(const nlohmann::ordered_json& value);

/// The beginning of a text that may be anything, `limit` bytes or a few more, for quoting in a
/// message: what is not printable in UTF-8 becomes a question mark.
std::string one_line(std::string_view text, std::size_t limit = 80);

}  // namespace fogbench::config
