#pragma once
// What only one process may have at a time: an instrument, a run log that is served, a socket.
//
// A lock is the kernel's, on a file of its own (flock): it ends with its process, however that
// ends, and no power cut leaves one behind. What stands in the file only tells the next one who
// has it.

#include <sys/types.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "config/result.hpp"
#include "drivers/file_descriptor.hpp"

namespace fogbench::drivers {

class ProcessLock {
 public:
  /// `file` is made with `mode`, whatever the umask, where there is none. Errors: kHeld, "`what` is
  /// held by process 1234 (fogbenchd)"; kDevice when the file cannot be made or opened.
  static Result<std::unique_ptr<ProcessLock>> take(const std::filesystem::path& file, mode_t mode,
                                                   const std::string& what);
  ProcessLock(const ProcessLock&) = delete;
  ProcessLock& operator=(const ProcessLock&) = delete;
  /// Removes the file where that is allowed.
  ~ProcessLock();

 private:
  ProcessLock(int fd, std::filesystem::path file) : fd_(fd), file_(std::move(file)) {}
  FileDescriptor fd_;
  std::filesystem::path file_;
};

/// On each name of one instrument.
using InstrumentLock = std::vector<std::unique_ptr<ProcessLock>>;

/// The lock on an instrument, which must be held from before its first byte until after its last,
/// through all the time that it is unplugged. A name is such that two who mean the same instrument
/// say the same: "serial line /dev/ttyUSB0"; a second one that is the first again is left out.
///
/// The lock files are in one folder for all users of the machine, so that a service and a person
/// exclude each other: $FOGBENCH_LOCKS; else /run/lock where everybody may write, as on Debian;
/// else /tmp. Errors: as ProcessLock::take.
Result<InstrumentLock> lock_instrument(const std::vector<std::string>& names);

/// Who has this file open, another process than this one: "process 1234 (minicom)"; "another
/// process" when that cannot be seen. For what is held by programs that know nothing of our locks.
std::string holder_of(const std::filesystem::path& file);

/// `what` is held by `who`.
Error held(const std::string& what, const std::string& who);

}  // namespace fogbench::drivers
