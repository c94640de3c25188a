#include "config/scratch_folder.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstdlib>
#include <string>
#include <system_error>
#include <utility>

namespace fogbench::config {
namespace fs = std::filesystem;

Result<ScratchFolder> ScratchFolder::make() {
  std::error_code error;
  const fs::path root = fs::temp_directory_path(error);
  std::string pattern = (root / "fogbench-XXXXXX").string();
  if (!error && mkdtemp(pattern.data()) == nullptr) error.assign(errno, std::generic_category());
  if (!error) return ScratchFolder(pattern);
  return Error{ErrorCode::kStore,
               fmt::format("{}: no folder for temporary files can be made: {}",
                           root.empty() ? "TMPDIR" : root.string(), error.message())};
}

ScratchFolder::ScratchFolder(ScratchFolder&& other) noexcept
    : path_(std::exchange(other.path_, {})) {}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  if (!path_.empty()) fs::remove_all(path_, ignored);
}

}  // namespace fogbench::config
