#include "tests/system/far_bench/packet_listener.hpp"

#include <sys/socket.h>
#include <sys/un.h>

#include <system_error>

namespace fogbench::far_bench {

std::optional<PacketListener> PacketListener::open(const std::filesystem::path& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.string().size() >= sizeof address.sun_path) return std::nullopt;
  path.string().copy(address.sun_path, sizeof address.sun_path - 1);
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
  drivers::FileDescriptor made(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  constexpr int kWaiting = 8;
  if (!made || bind(made.get(), reinterpret_cast<sockaddr*>(&address), sizeof address) != 0 ||
      listen(made.get(), kWaiting) != 0) {
    return std::nullopt;
  }
  return PacketListener(std::move(made), path);
}

PacketListener::~PacketListener() {
  std::error_code ignored;
  if (descriptor_) std::filesystem::remove(path_, ignored);
}

drivers::FileDescriptor PacketListener::accept() const {
  return drivers::FileDescriptor(
      accept4(descriptor_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
}

}  // namespace fogbench::far_bench
