#pragma once
// SHA-256 of a file, as sha256sum prints it: what a fitted model says it was fitted to.

#include <filesystem>
#include <string>

#include "config/result.hpp"

namespace fogbench::record {

/// 64 hexadecimal digits. Errors: kBadInput when the file cannot be read.
Result<std::string> file_sha256(const std::filesystem::path& file);

}  // namespace fogbench::record
