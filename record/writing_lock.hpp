#pragma once
// Which runs of a store are being written at this moment, by whatever program. Beside the store is
// an empty file (fogbench.db.writing); whoever writes run N holds a lock on its byte N. The kernel
// drops it when the process ends, however it ends, and no power cut leaves one behind: a run
// without an end that nobody holds was interrupted.
//
// Not on the store itself: closing one more descriptor of it would drop SQLite's own locks.

#include <cstdint>
#include <filesystem>
#include <memory>

#include "config/result.hpp"
#include "drivers/file_descriptor.hpp"

namespace fogbench::record {

class WritingLock {
 public:
  /// Makes the file where there is none. Errors: kStore.
  static Result<std::unique_ptr<WritingLock>> open(const std::filesystem::path& store);
  /// Holds this run, and no other any longer. Errors: kStore.
  Status hold(std::int64_t run);
  void release();

  /// Whether anybody holds the run, this process included.
  static bool held(const std::filesystem::path& store, std::int64_t run);

 private:
  WritingLock(int fd, std::filesystem::path path);
  drivers::FileDescriptor file_;
  std::filesystem::path path_;
};

}  // namespace fogbench::record
