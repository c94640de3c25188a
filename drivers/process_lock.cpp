#include "drivers/process_lock.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <fstream>
#include <system_error>

namespace fogbench::drivers {
namespace fs = std::filesystem;
namespace {

/// Between opening a lock file and locking it, its last owner may have removed it.
constexpr int kMostTries = 100;

constexpr auto kNobodyKnown = "another process";

std::string text_of_process(pid_t pid, const std::string& name) {
  if (pid == getpid()) return "this program already";
  return name.empty() ? fmt::format("process {}", pid) : fmt::format("process {} ({})", pid, name);
}

/// What a living process is called; empty when it cannot be seen.
std::string name_of_process(pid_t pid) {
  std::ifstream file(fmt::format("/proc/{}/comm", pid));
  std::string name;
  std::getline(file, name);
  return name;
}

pid_t pid_in(std::string_view text) {
  pid_t pid = 0;
  std::from_chars(text.data(), text.data() + text.size(), pid);
  return pid;
}

/// Who wrote the lock file, "1234 fogbenchd".
std::string writer_of(int fd) {
  std::array<char, 64> bytes{};
  const ssize_t count = pread(fd, bytes.data(), bytes.size(), 0);
  const std::string_view text(bytes.data(), static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  const pid_t pid = pid_in(text);
  if (pid <= 0) return kNobodyKnown;
  const std::string_view behind = text.substr(std::min(text.find(' ') + 1, text.size()));
  return text_of_process(pid, std::string(behind.substr(0, behind.find('\n'))));
}

void write_owner(int fd) {
  const std::string text = fmt::format("{} {}\n", getpid(), name_of_process(getpid()));
  // Without room for it the lock holds all the same; only its owner is not known.
  if (ftruncate(fd, 0) != 0 || pwrite(fd, text.data(), text.size(), 0) < 0) return;
}

/// Opened as it is, else made. Never both at once: a kernel that protects folders in which
/// everybody may write refuses to make what another user has there.
int open_or_make(const fs::path& file, mode_t mode) {
  constexpr int kFlags = O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK;
  const int there = ::open(file.c_str(), kFlags);
  if (there >= 0 || errno != ENOENT) return there;
  const int made = ::open(file.c_str(), kFlags | O_CREAT | O_EXCL, mode);
  if (made >= 0) fchmod(made, mode);
  return made;
}

bool is_still_there(int fd, const fs::path& file) {
  struct stat opened {
  }, named{};
  return fstat(fd, &opened) == 0 && lstat(file.c_str(), &named) == 0 &&
         opened.st_ino == named.st_ino && opened.st_dev == named.st_dev;
}

fs::path folder_of_locks() {
  const char* chosen = std::getenv("FOGBENCH_LOCKS");  // NOLINT(concurrency-mt-unsafe)
  if (chosen != nullptr && *chosen != '\0') return chosen;
  constexpr auto kUsual = "/run/lock";
  struct stat usual {};
  const bool for_all = stat(kUsual, &usual) == 0 && (usual.st_mode & S_IWOTH) != 0;
  return for_all ? kUsual : "/tmp";
}

std::string file_name_of(const std::string& instrument) {
  std::string name = "fogbench.";
  for (const char c : instrument) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0 || std::string_view(".:-").find(c) != std::string_view::npos) {
      name += c;
    } else {
      name += c == ' ' ? "_" : fmt::format("%{:02X}", byte);
    }
  }
  return name;
}

bool has_open(pid_t pid, const fs::path& wanted) {
  std::error_code error, gone;
  fs::directory_iterator opened(fmt::format("/proc/{}/fd", pid), error);
  for (; !error && opened != fs::directory_iterator(); opened.increment(error)) {
    if (fs::read_symlink(opened->path(), gone) == wanted) return true;
  }
  return false;
}

}  // namespace

Error held(const std::string& what, const std::string& who) {
  return Error{ErrorCode::kHeld, fmt::format("{} is held by {}", what, who)};
}

Result<std::unique_ptr<ProcessLock>> ProcessLock::take(const fs::path& file, mode_t mode,
                                                       const std::string& what) {
  for (int tries = 0; tries < kMostTries; ++tries) {
    const int fd = open_or_make(file, mode);
    if (fd < 0 && errno == EEXIST) continue;
    if (fd < 0) break;
    std::unique_ptr<ProcessLock> lock(new ProcessLock(fd, file));
    if (flock(fd, LOCK_EX | LOCK_NB) != 0) {
      lock->file_.clear();  // another's to remove
      if (errno == EWOULDBLOCK) return held(what, writer_of(fd));
      break;
    }
    if (is_still_there(fd, file)) {
      write_owner(fd);
      return lock;
    }
    lock->file_.clear();
  }
  return Error{ErrorCode::kDevice, fmt::format("{} cannot be locked: {}: {}", what, file.string(),
                                               std::generic_category().message(errno))};
}

ProcessLock::~ProcessLock() {
  if (!file_.empty()) unlink(file_.c_str());
}

Result<InstrumentLock> lock_instrument(const std::vector<std::string>& names) {
  constexpr mode_t kForAll = 0666;
  InstrumentLock locks;
  for (auto name = names.begin(); name != names.end(); ++name) {
    if (std::find(names.begin(), name, *name) != name) continue;
    auto lock = ProcessLock::take(folder_of_locks() / file_name_of(*name), kForAll, *name);
    if (!lock) return lock.error();
    locks.push_back(std::move(*lock));
  }
  return locks;
}

std::string holder_of(const fs::path& file) {
  std::error_code error;
  const fs::path wanted = fs::canonical(file, error);
  if (error) return kNobodyKnown;
  // A process may end while it is looked at: nothing here may throw for that.
  fs::directory_iterator process("/proc", error);
  for (; !error && process != fs::directory_iterator(); process.increment(error)) {
    const pid_t pid = pid_in(process->path().filename().string());
    if (pid > 0 && pid != getpid() && has_open(pid, wanted)) {
      return text_of_process(pid, name_of_process(pid));
    }
  }
  return kNobodyKnown;
}

}  // namespace fogbench::drivers
