#include "drivers/exclusive_tty.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

namespace fogbench::drivers {
namespace {

std::string line_named(const std::string& tty) {
  return "serial line " + tty;
}

/// The kernel's list of devices: Unix98 pseudo-terminals' other sides.
bool is_pseudo_terminal(int fd) {
  struct stat device {};
  return fstat(fd, &device) == 0 && major(device.st_rdev) >= 136 && major(device.st_rdev) <= 143;
}

/// The superuser's open() is not refused.
bool is_shut(int fd) {
  int exclusive = 0;
  return !is_pseudo_terminal(fd) && ioctl(fd, TIOCGEXCL, &exclusive) == 0 && exclusive != 0;
}

}  // namespace

Result<InstrumentLock> lock_serial_line(const std::string& tty) {
  std::error_code error;
  const std::filesystem::path device = std::filesystem::canonical(tty, error);
  return lock_instrument({line_named(tty), line_named(error ? tty : device.string())});
}

Result<std::unique_ptr<FileDescriptor>> open_exclusively(const std::string& tty) {
  auto line = std::make_unique<FileDescriptor>(
      ::open(tty.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (line->get() < 0) {
    if (errno == EBUSY) return held(line_named(tty), holder_of(tty));
    return Error{ErrorCode::kUnplugged,
                 fmt::format("cannot open {}: {}", tty, std::generic_category().message(errno))};
  }
  if (isatty(line->get()) != 1) {
    return Error{ErrorCode::kUnplugged, fmt::format("{} is not a serial line: {}", tty,
                                                    std::generic_category().message(errno))};
  }
  if (is_shut(line->get()) || flock(line->get(), LOCK_EX | LOCK_NB) != 0) {
    return held(line_named(tty), holder_of(tty));
  }
  return line;
}

void shut_others_out(int fd) {
  if (!is_pseudo_terminal(fd)) ioctl(fd, TIOCEXCL);
}

}  // namespace fogbench::drivers
