#include "drivers/serial_port.hpp"

// Not <termios.h>: only the kernel's own structure takes rates that have no constant.
#include <asm/termbits.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <system_error>

#include "drivers/deadline.hpp"
#include "drivers/file_descriptor.hpp"
#include "drivers/reconnect.hpp"

namespace fogbench::drivers {
namespace {

constexpr Clock::Duration kWriteTimeout = std::chrono::seconds{1};

/// A start bit finds its frame again every ten bits: 3 % is what a receiver bears.
constexpr double kRateTolerance = 0.03;

std::string reason(int error) {
  return std::generic_category().message(error);
}

Status make_raw(int fd, std::uint32_t baud) {
  struct termios2 line {};
  if (ioctl(fd, TCGETS2, &line) != 0) {
    return Error{ErrorCode::kUnplugged, "is not a serial line: " + reason(errno)};
  }
  line.c_iflag = 0;
  line.c_oflag = 0;
  line.c_lflag = 0;
  line.c_cflag = BOTHER | CS8 | CREAD | CLOCAL;
  line.c_ispeed = baud;
  line.c_ospeed = baud;
  // With VMIN 1 an empty line is EAGAIN, and only a line that has hung up reads 0 bytes.
  line.c_cc[VMIN] = 1;
  line.c_cc[VTIME] = 0;
  if (ioctl(fd, TCSETS2, &line) != 0 || ioctl(fd, TCGETS2, &line) != 0) {
    return Error{ErrorCode::kUnplugged,
                 fmt::format("cannot run at {} baud: {}", baud, reason(errno))};
  }
  if (std::abs(static_cast<double>(line.c_ospeed) - baud) > kRateTolerance * baud) {
    return Error{ErrorCode::kUnplugged,
                 fmt::format("runs at {} baud when asked for {}", line.c_ospeed, baud)};
  }
  return {};
}

Result<std::unique_ptr<FileDescriptor>> open_line(const std::string& tty, std::uint32_t baud) {
  auto line = std::make_unique<FileDescriptor>(
      ::open(tty.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (line->get() < 0) {
    return Error{ErrorCode::kUnplugged, fmt::format("cannot open {}: {}", tty, reason(errno))};
  }
  if (const Status raw = make_raw(line->get(), baud); !raw) {
    return Error{raw.error().code, tty + " " + raw.error().message};
  }
  // Two readers would each get half of the stream.
  ioctl(line->get(), TIOCEXCL);
  ioctl(line->get(), TCFLSH, TCIOFLUSH);
  return line;
}

class SerialPort final : public SerialTransport {
 public:
  SerialPort(std::string tty, std::uint32_t baud, Clock& clock)
      : tty_(std::move(tty)), line_(clock, [this, baud] { return open_line(tty_, baud); }) {}

  Status connect() {
    const auto line = line_.get();
    return line ? Status{} : line.error();
  }

  Result<std::size_t> read_some(std::span<std::byte> out) override {
    const auto line = line_.get();
    if (!line) return line.error();
    const ssize_t count = ::read((*line)->get(), out.data(), out.size());
    if (count > 0) return static_cast<std::size_t>(count);
    if (count < 0 && (errno == EAGAIN || errno == EINTR)) return std::size_t{0};
    return lost(count == 0 ? "it has hung up" : reason(errno));
  }

  Status write(std::span<const std::byte> bytes) override {
    const auto line = line_.get();
    if (!line) return line.error();
    const Deadline deadline(kWriteTimeout);
    while (!bytes.empty()) {
      const ssize_t count = ::write((*line)->get(), bytes.data(), bytes.size());
      if (count >= 0) {
        bytes = bytes.subspan(static_cast<std::size_t>(count));
        continue;
      }
      if (errno != EAGAIN && errno != EINTR) return lost(reason(errno));
      pollfd room{(*line)->get(), POLLOUT, 0};
      if (::poll(&room, 1, deadline.left_ms()) == 0 || deadline.passed()) {
        ioctl((*line)->get(), TCFLSH, TCOFLUSH);
        return Error{ErrorCode::kTimeout,
                     fmt::format("{} does not take {} bytes", tty_, bytes.size())};
      }
    }
    return {};
  }

 private:
  Error lost(const std::string& why) {
    line_.lost();
    return {ErrorCode::kUnplugged, fmt::format("{} is gone: {}", tty_, why)};
  }

  std::string tty_;
  Reconnecting<FileDescriptor> line_;
};

}  // namespace

Result<std::unique_ptr<SerialTransport>> open_serial(const std::string& tty, std::uint32_t baud,
                                                     Clock& clock) {
  auto port = std::make_unique<SerialPort>(tty, baud, clock);
  if (const Status connected = port->connect(); !connected) return connected.error();
  return Result<std::unique_ptr<SerialTransport>>(std::move(port));
}

}  // namespace fogbench::drivers
