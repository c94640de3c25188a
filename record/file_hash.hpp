#pragma once
// SHA-256 of a file or a text, as sha256sum prints it: what a fitted model says it was fitted to.

#include <filesystem>
#include <string>
#include <string_view>

#include "config/result.hpp"

namespace fogbench::record {

/// 64 hexadecimal digits. Errors: kBadInput when the file cannot be read.
Result<std::string> file_sha256(const std::filesystem::path& file);
std::string text_sha256(std::string_view text);

}  // namespace fogbench::record
