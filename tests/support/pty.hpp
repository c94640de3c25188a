#pragma once
// A pseudo-terminal: the test holds one end, the port opens the other by a path of its own, which
// stays when the line is unplugged and plugged in again.

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.hpp"

namespace fogbench::support {

class Pty {
 public:
  Pty() { plug_in(); }
  Pty(const Pty&) = delete;
  Pty& operator=(const Pty&) = delete;
  ~Pty() { unplug(); }

  std::string path() const { return link_.string(); }
  int fd() const { return fd_; }

  void plug_in() {
    fd_ = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    char name[64] = {};
    if (fd_ < 0 || grantpt(fd_) != 0 || unlockpt(fd_) != 0 || ptsname_r(fd_, name, 64) != 0) {
      std::abort();
    }
    std::filesystem::create_symlink(name, link_);
  }
  void unplug() {
    if (fd_ < 0) return;
    close(fd_);
    fd_ = -1;
    std::filesystem::remove(link_);
  }

  void send(std::span<const std::uint8_t> bytes) const {
    if (write(fd_, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size())) std::abort();
  }
  void send(const std::string& text) const {
    send(std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
  }
  /// Waits until `count` bytes have come, at most two seconds.
  std::string receive(std::size_t count) const {
    std::string received;
    pollfd arrived{fd_, POLLIN, 0};
    while (received.size() < count && poll(&arrived, 1, 2000) > 0) {
      char buffer[256];
      const ssize_t got = read(fd_, buffer, std::min(sizeof buffer, count - received.size()));
      if (got <= 0) break;
      received.append(buffer, static_cast<std::size_t>(got));
    }
    return received;
  }

 private:
  TemporaryFolder folder_;
  std::filesystem::path link_ = folder_.path() / "line";
  int fd_ = -1;
};

}  // namespace fogbench::support
