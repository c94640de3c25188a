#pragma once
// The Unix socket that fogbenchd listens on: made here, or handed over by systemd.

#include <sys/types.h>

#include <filesystem>
#include <memory>
#include <string>

#include "config/result.hpp"
#include "drivers/file_descriptor.hpp"
#include "drivers/process_lock.hpp"

namespace fogbench::daemon {

/// Where the daemon listens: $FOGBENCH_SOCKET; else fogbench/control.sock under
/// $RUNTIME_DIRECTORY's parent, /run for root, $XDG_RUNTIME_DIR for a user. kBadInput when there is
/// none of them.
Result<std::filesystem::path> socket_to_serve();
/// Where a client looks: $FOGBENCH_SOCKET; else the user's own daemon when its socket exists; else
/// the service's.
std::filesystem::path socket_to_ask();

/// kBadInput when the path is longer than a Unix socket's name may be.
Status check_socket_path(const std::filesystem::path& path);

class ControlSocket {
 public:
  /// Listens, without blocking. The folder must exist, but for the default places' own, which is
  /// made with mode 0755. A lock file beside the socket, held until the end, tells a socket that a
  /// dead daemon left from one that a living daemon serves. Errors: kHeld, which names that daemon;
  /// kDevice, one line with the path.
  static Result<std::unique_ptr<ControlSocket>> open(const std::filesystem::path& path,
                                                     mode_t mode);
  /// The socket that systemd listens on for this process (LISTEN_FDS); null when there is none.
  /// kDevice when it hands over anything but one listening Unix socket.
  static Result<std::unique_ptr<ControlSocket>> inherited();

  ControlSocket(const ControlSocket&) = delete;
  ControlSocket& operator=(const ControlSocket&) = delete;
  /// Removes the socket's name when it was made here.
  ~ControlSocket();

  int descriptor() const { return socket_.get(); }
  /// Its path, or that systemd gave it.
  const std::string& name() const { return name_; }

 private:
  ControlSocket(int socket, std::unique_ptr<drivers::ProcessLock> lock, std::string name)
      : socket_(socket), lock_(std::move(lock)), name_(std::move(name)) {}

  drivers::FileDescriptor socket_;
  std::unique_ptr<drivers::ProcessLock> lock_;  ///< null when it was inherited
  std::string name_;
  std::filesystem::path made_;  ///< empty when it was inherited
};

}  // namespace fogbench::daemon
