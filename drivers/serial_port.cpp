#include "drivers/serial_port.hpp"

// Not <termios.h>: only the kernel's own structure takes rates that have no constant.
#include <asm/termbits.h>
#include <fmt/format.h>
#include <poll.h>
#include <pthread.h>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>
#include <tuple>
#include <vector>

#include "drivers/deadline.hpp"
#include "drivers/exclusive_tty.hpp"
#include "drivers/file_descriptor.hpp"
#include "drivers/reconnect.hpp"
#include "drivers/usb_adapter.hpp"

namespace fogbench::drivers {
namespace {

constexpr Clock::Duration kWriteTimeout = std::chrono::seconds{1};

/// A start bit finds its frame again every ten bits: 3 % is what a receiver bears.
constexpr double kRateTolerance = 0.03;

constexpr std::size_t kMostAtOnce = 4096;
/// Four minutes of a gyro with 36 bytes a thousand times a second.
constexpr std::size_t kMostKept = std::size_t{8} << 20;

std::string reason(int error) {
  return std::generic_category().message(error);
}

Status make_raw(int fd, std::uint32_t baud) {
  struct termios2 line {};
  if (ioctl(fd, TCGETS2, &line) != 0) {
    return Error{ErrorCode::kUnplugged, "has no line settings: " + reason(errno)};
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
  auto line = open_exclusively(tty);
  if (!line) return line.error();
  const int fd = (*line)->get();
  if (const Status raw = make_raw(fd, baud); !raw) {
    return Error{raw.error().code, tty + " " + raw.error().message};
  }
  shut_others_out(fd);
  ioctl(fd, TCFLSH, TCIOFLUSH);
  return line;
}

/// An open line and what has come from it. Its thread ends with it, or with the line.
class Line {
 public:
  explicit Line(std::unique_ptr<FileDescriptor> opened)
      : fd_(std::move(opened)), stop_(eventfd(0, EFD_CLOEXEC)) {
    // The process's signals are for the thread that waits for a person or an instrument.
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    thread_ = std::thread([this] { receive(); });
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    pthread_setname_np(thread_.native_handle(), "serial");
  }
  Line(const Line&) = delete;
  Line& operator=(const Line&) = delete;
  ~Line() {
    eventfd_write(stop_.get(), 1);
    thread_.join();
  }

  int fd() const { return fd_->get(); }

  /// At most out.size() bytes; an error only when all that had come is taken.
  Result<std::size_t> take(std::span<std::byte> out) {
    const std::lock_guard lock(mutex_);
    // On a busy machine the kernel has bytes that the thread has had no time for.
    if (taken_ == arrived_.size() && failure_.empty()) receive_some();
    const std::size_t count = std::min(out.size(), arrived_.size() - taken_);
    if (count == 0 && !failure_.empty()) return Error{ErrorCode::kUnplugged, failure_};
    std::copy_n(arrived_.begin() + static_cast<std::ptrdiff_t>(taken_), count, out.begin());
    taken_ += count;
    if (taken_ == arrived_.size()) {
      arrived_.clear();
      taken_ = 0;
    }
    return count;
  }

 private:
  void receive() {
    pollfd ready[] = {{fd(), POLLIN, 0}, {stop_.get(), POLLIN, 0}};
    while (::poll(ready, 2, -1) >= 0 || errno == EINTR) {
      if (ready[1].revents != 0) return;
      const std::lock_guard lock(mutex_);
      receive_some();
      if (!failure_.empty()) return;
    }
  }

  /// Under mutex_, so that bytes read later do not come before. Never waits.
  void receive_some() {
    const ssize_t count = ::read(fd(), bytes_.data(), bytes_.size());
    if (count < 0 && (errno == EAGAIN || errno == EINTR)) return;
    failure_ = count == 0 ? "it has hung up" : count < 0 ? reason(errno) : "";
    // When nobody has asked for minutes the newest is lost, as it would be in the kernel.
    if (count > 0 && arrived_.size() < kMostKept) {
      arrived_.insert(arrived_.end(), bytes_.begin(), bytes_.begin() + count);
    }
  }

  std::unique_ptr<FileDescriptor> fd_;
  FileDescriptor stop_;
  std::mutex mutex_;
  std::array<std::byte, kMostAtOnce> bytes_;
  std::vector<std::byte> arrived_;  ///< of which the first taken_ were asked for
  std::size_t taken_ = 0;
  std::string failure_;  ///< why the line has ended; empty while it has not
  std::thread thread_;
};

class SerialPort final : public SerialTransport {
 public:
  SerialPort(std::string tty, std::uint32_t baud, InstrumentLock lock, Clock& clock)
      : tty_(std::move(tty)),
        lock_(std::move(lock)),
        line_(clock, [this, baud]() -> Result<std::unique_ptr<Line>> {
          auto opened = open_line(tty_, baud);
          if (!opened) return opened.error();
          if (Status same = check_adapter(); !same) return same.error();
          return std::make_unique<Line>(std::move(*opened));
        }) {}

  Result<std::size_t> read_some(std::span<std::byte> out) override {
    const auto line = line_.get();
    if (!line) return line.error();
    const auto count = (*line)->take(out);
    return count ? count : lost(count.error().message);
  }

  Status write(std::span<const std::byte> bytes) override {
    const auto line = line_.get();
    if (!line) return line.error();
    const int fd = (*line)->fd();
    const Deadline deadline(kWriteTimeout);
    while (!bytes.empty()) {
      const ssize_t count = ::write(fd, bytes.data(), bytes.size());
      if (count >= 0) {
        bytes = bytes.subspan(static_cast<std::size_t>(count));
        continue;
      }
      if (errno != EAGAIN && errno != EINTR) return lost(reason(errno));
      pollfd room{fd, POLLOUT, 0};
      if (::poll(&room, 1, deadline.left_ms()) == 0 || deadline.passed()) {
        ioctl(fd, TCFLSH, TCOFLUSH);
        return Error{ErrorCode::kTimeout,
                     fmt::format("{} does not take {} bytes", tty_, bytes.size())};
      }
    }
    return {};
  }

  void write_last(std::span<const std::byte> bytes) noexcept override {
    line_.last_words(
        [&](const Line& line) { std::ignore = ::write(line.fd(), bytes.data(), bytes.size()); });
  }

 private:
  /// A name such as /dev/ttyUSB0 may belong to another adapter after the first one was pulled.
  Status check_adapter() {
    const std::string adapter = usb_adapter_of(tty_);
    if (!adapter_) adapter_ = adapter;
    if (adapter == *adapter_) return {};
    return Error{ErrorCode::kUnplugged,
                 fmt::format("{} is another adapter now: found {}, expected "
                             "{}",
                             tty_, adapter.empty() ? "none" : adapter, *adapter_)};
  }

  Error lost(const std::string& why) {
    line_.lost();
    return {ErrorCode::kUnplugged, fmt::format("{} is gone: {}", tty_, why)};
  }

  std::string tty_;
  InstrumentLock lock_;
  std::optional<std::string> adapter_;  ///< when the line was first opened
  Reconnecting<Line> line_;
};

}  // namespace

Result<std::unique_ptr<SerialTransport>> open_serial(const std::string& tty, std::uint32_t baud,
                                                     Clock& clock) {
  auto lock = lock_serial_line(tty);
  if (!lock) return lock.error();
  return Result<std::unique_ptr<SerialTransport>>(
      std::make_unique<SerialPort>(tty, baud, std::move(*lock), clock));
}

}  // namespace fogbench::drivers
