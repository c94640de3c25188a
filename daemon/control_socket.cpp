#include "daemon/control_socket.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <system_error>

namespace fogbench::daemon {
namespace fs = std::filesystem;
namespace {

constexpr auto kServicePath = "/run/fogbench/control.sock";
constexpr auto kUnderRuntime = "fogbench/control.sock";
/// As many as the kernel lets wait (net.core.somaxconn caps it).
constexpr int kBacklog = 1024;
/// The first descriptor that systemd hands over (sd_listen_fds(3)).
constexpr int kFirstInherited = 3;

/// Empty when it is not set.
std::string variable(const char* name) {
  const char* value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): nothing sets variables
  return value == nullptr ? "" : value;
}

Error not_served(const std::string& where, const std::string& what) {
  return Error{ErrorCode::kDevice, fmt::format("control socket {}: {}", where, what)};
}

Error not_served(const std::string& where) {
  return not_served(where, std::generic_category().message(errno));
}

/// Missing folders of the default places.
Status make_folder(const fs::path& path) {
  const bool standard =
      path == kServicePath || path == fs::path(variable("XDG_RUNTIME_DIR")) / kUnderRuntime;
  if (!standard || mkdir(path.parent_path().c_str(), 0755) == 0 || errno == EEXIST) return {};
  return not_served(path.string(), fmt::format("{}: {}", path.parent_path().string(),
                                               std::generic_category().message(errno)));
}

sockaddr_un address_of(const fs::path& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
  return address;
}

int integer_option(int socket, int option) {
  int value = -1;
  socklen_t length = sizeof value;
  return getsockopt(socket, SOL_SOCKET, option, &value, &length) == 0 ? value : -1;
}

}  // namespace

Result<fs::path> socket_to_serve() {
  if (const std::string set = variable("FOGBENCH_SOCKET"); !set.empty()) return fs::path(set);
  if (const std::string made = variable("RUNTIME_DIRECTORY"); !made.empty()) {
    return fs::path(made) / "control.sock";
  }
  if (geteuid() == 0) return fs::path(kServicePath);
  const std::string runtime = variable("XDG_RUNTIME_DIR");
  if (!runtime.empty()) return fs::path(runtime) / kUnderRuntime;
  return config::bad_input(
      "no place for the control socket: XDG_RUNTIME_DIR is not set; name one with --socket");
}

fs::path socket_to_ask() {
  if (const std::string set = variable("FOGBENCH_SOCKET"); !set.empty()) return set;
  const fs::path own = fs::path(variable("XDG_RUNTIME_DIR")) / kUnderRuntime;
  std::error_code ignored;
  if (own.is_absolute() && fs::exists(own, ignored)) return own;
  return kServicePath;
}

Status check_socket_path(const fs::path& path) {
  constexpr std::size_t kLongest = sizeof(sockaddr_un::sun_path) - 1;
  if (path.native().size() <= kLongest && !path.empty()) return {};
  return config::bad_input(fmt::format("control socket {}: {} bytes, expected 1 to {}",
                                       path.string(), path.native().size(), kLongest));
}

Result<std::unique_ptr<ControlSocket>> ControlSocket::open(const fs::path& path, mode_t mode) {
  if (const Status ok = check_socket_path(path); !ok) return ok.error();
  if (const Status ok = make_folder(path); !ok) return ok.error();
  const std::string name = path.string();
  auto lock = drivers::ProcessLock::take(name + ".lock", 0600, "control socket " + name);
  if (!lock) return lock.error();
  const int socket = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  std::unique_ptr<ControlSocket> opened(new ControlSocket(socket, std::move(*lock), name));
  if (socket < 0) return not_served(name);
  struct stat there {};
  if (lstat(name.c_str(), &there) == 0) {
    if (!S_ISSOCK(there.st_mode)) return not_served(name, "there is a file that is no socket");
    // The lock is ours, so whoever made it is dead.
    if (unlink(name.c_str()) != 0) return not_served(name);
  }
  const sockaddr_un address = address_of(path);
  // Nobody gets in between the name and its mode.
  const mode_t before = umask(0177);
  const int bound = bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address);
  umask(before);
  if (bound != 0) return not_served(name);
  opened->made_ = path;
  if (chmod(name.c_str(), mode) != 0 || listen(socket, kBacklog) != 0) return not_served(name);
  return opened;
}

Result<std::unique_ptr<ControlSocket>> ControlSocket::inherited() {
  if (variable("LISTEN_PID") != std::to_string(getpid())) return std::unique_ptr<ControlSocket>();
  const std::string count = variable("LISTEN_FDS");
  const std::string name = "from systemd";
  if (count != "1") {
    return not_served(name, fmt::format("LISTEN_FDS is \"{}\", expected one socket", count));
  }
  if (integer_option(kFirstInherited, SO_DOMAIN) != AF_UNIX ||
      integer_option(kFirstInherited, SO_TYPE) != SOCK_STREAM ||
      integer_option(kFirstInherited, SO_ACCEPTCONN) != 1) {
    return not_served(name, "expected a listening Unix stream socket (ListenStream=)");
  }
  fcntl(kFirstInherited, F_SETFD, FD_CLOEXEC);
  fcntl(kFirstInherited, F_SETFL, fcntl(kFirstInherited, F_GETFL) | O_NONBLOCK);
  return std::unique_ptr<ControlSocket>(new ControlSocket(kFirstInherited, nullptr, name));
}

ControlSocket::~ControlSocket() {
  if (!made_.empty()) unlink(made_.c_str());
}

}  // namespace fogbench::daemon
