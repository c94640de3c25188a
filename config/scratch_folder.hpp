#pragma once

#include <filesystem>

#include "config/result.hpp"

namespace fogbench::config {

/// A folder of its own below the system's for temporary files; it goes with all that is in it.
class ScratchFolder {
 public:
  /// kStore when none can be made.
  static Result<ScratchFolder> make();
  ScratchFolder(ScratchFolder&& other) noexcept;
  ScratchFolder& operator=(ScratchFolder&&) = delete;
  ~ScratchFolder();

  const std::filesystem::path& path() const { return path_; }

 private:
  explicit ScratchFolder(std::filesystem::path path) : path_(std::move(path)) {}
  std::filesystem::path path_;  ///< empty when it was moved away
};

}  // namespace fogbench::config
