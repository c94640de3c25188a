#pragma once

#include <unistd.h>

namespace fogbench::drivers {

/// Closes what it holds.
class FileDescriptor {
 public:
  explicit FileDescriptor(int fd) : fd_(fd) {}
  FileDescriptor(const FileDescriptor&) = delete;
  FileDescriptor& operator=(const FileDescriptor&) = delete;
  ~FileDescriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  /// Negative when nothing could be opened.
  int get() const { return fd_; }

 private:
  int fd_;
};

}  // namespace fogbench::drivers
