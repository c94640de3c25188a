#include "simulator/wire/tcp_listener.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>

namespace fogbench::simulator {

Result<TcpListener> TcpListener::open(const std::string& address, std::uint16_t port) {
  const auto failed = [&](const char* why) {
    return Error{ErrorCode::kDevice,
                 fmt::format("tcp:{}:{}: cannot listen there: {}", address, port, why)};
  };
  sockaddr_in where{};
  where.sin_family = AF_INET;
  where.sin_port = htons(port);
  if (inet_pton(AF_INET, address.c_str(), &where.sin_addr) != 1) {
    return failed("an IPv4 address in numbers was expected, such as 127.0.0.1");
  }
  drivers::FileDescriptor listener(socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!listener) return failed(std::strerror(errno));
  const int yes = 1;
  setsockopt(listener.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  auto* const any = reinterpret_cast<sockaddr*>(&where);
  socklen_t size = sizeof where;
  constexpr int kBacklog = 64;
  if (bind(listener.get(), any, size) != 0 || ::listen(listener.get(), kBacklog) != 0 ||
      getsockname(listener.get(), any, &size) != 0) {
    return failed(std::strerror(errno));
  }
  return TcpListener(std::move(listener), ntohs(where.sin_port));
}

drivers::FileDescriptor TcpListener::accept() {
  drivers::FileDescriptor taken(
      ::accept4(descriptor_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
  const int yes = 1;
  if (taken) setsockopt(taken.get(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  return taken;
}

}  // namespace fogbench::simulator
