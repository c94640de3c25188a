#pragma once
// A file that appears whole or not at all: written beside its place under a temporary name, and
// renamed when it is complete. Until commit() the old file, if any, stays as it was.

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string_view>

#include "config/result.hpp"

namespace fogbench::config {

class OutputFile {
 public:
  /// "-" is standard output. It, and whatever else is not a regular file (a pipe, a terminal), is
  /// written directly; what a symbolic link points to is replaced, not the link.
  /// Errors of every call: kBadInput with the path and the system's reason.
  static Result<std::unique_ptr<OutputFile>> open(const std::filesystem::path& path);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  /// Removes the temporary file when commit() has not been reached.
  ~OutputFile();

  Status write(std::string_view text);
  /// Flushes to disk and renames. Nothing may be written afterwards.
  Status commit();

 private:
  OutputFile(std::filesystem::path path, std::filesystem::path temporary, std::FILE* file);
  Error error() const;

  std::filesystem::path path_;
  std::filesystem::path temporary_;  ///< empty when written directly
  std::FILE* file_;
};

/// Opens, writes and commits.
Status write_file(const std::filesystem::path& path, std::string_view text);

}  // namespace fogbench::config
