#include "record/writing_lock.hpp"

#include <fcntl.h>
#include <fmt/format.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "record/store.hpp"

namespace fogbench::record {
namespace fs = std::filesystem;

namespace {

fs::path writing_file(const fs::path& store) {
  return beside_store(store, ".writing");
}

/// One byte from `run`, or with `all` every byte there may be.
struct flock range(short type, std::int64_t run, bool all = false) {
  struct flock range {};
  range.l_type = type;
  range.l_whence = SEEK_SET;
  range.l_start = run;
  range.l_len = all ? 0 : 1;
  return range;
}

Error not_locked(const fs::path& path) {
  return Error{ErrorCode::kStore,
               fmt::format("{}: {}", path.string(), std::generic_category().message(errno))};
}

}  // namespace

WritingLock::WritingLock(int fd, fs::path path) : file_(fd), path_(std::move(path)) {}

Result<std::unique_ptr<WritingLock>> WritingLock::open(const fs::path& store) {
  fs::path path = writing_file(store);
  // Read-only is enough for a lock that is shared, whoever made the file.
  const int fd = ::open(path.c_str(), O_RDONLY | O_CREAT | O_CLOEXEC, 0644);
  if (fd < 0) return not_locked(path);
  return std::unique_ptr<WritingLock>(new WritingLock(fd, std::move(path)));
}

Status WritingLock::hold(std::int64_t run) {
  release();
  // Of the open file description, not of the process: seen by this process, too.
  struct flock lock = range(F_RDLCK, run);
  if (fcntl(file_.get(), F_OFD_SETLK, &lock) != 0) return not_locked(path_);
  return {};
}

void WritingLock::release() {
  struct flock every = range(F_UNLCK, 0, true);
  fcntl(file_.get(), F_OFD_SETLK, &every);
}

bool WritingLock::held(const fs::path& store, std::int64_t run) {
  const drivers::FileDescriptor file(::open(writing_file(store).c_str(), O_RDONLY | O_CLOEXEC));
  if (file.get() < 0) return false;
  struct flock other = range(F_WRLCK, run);
  return fcntl(file.get(), F_OFD_GETLK, &other) == 0 && other.l_type != F_UNLCK;
}

}  // namespace fogbench::record
