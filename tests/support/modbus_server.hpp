#pragma once
// A Modbus server of a few lines, on a thread of its own: TCP on the loop-back, RTU on a
// pseudo-terminal. What it answers, and when, is the test's.

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <thread>
#include <vector>

namespace fogbench::support {

using Bytes = std::vector<std::uint8_t>;

/// Of function 3 or 16, without what else TCP and RTU put around it.
struct ModbusRequest {
  std::uint8_t unit = 0, function = 0;
  std::uint16_t address = 0, count = 0;
  std::vector<std::uint16_t> values;
};

/// The answer's bytes after the unit: function and data.
inline Bytes registers_answer(const std::vector<std::uint16_t>& values) {
  Bytes pdu{3, static_cast<std::uint8_t>(2 * values.size())};
  for (const std::uint16_t v : values) {
    pdu.push_back(static_cast<std::uint8_t>(v >> 8));
    pdu.push_back(static_cast<std::uint8_t>(v));
  }
  return pdu;
}
inline Bytes written_answer(const ModbusRequest& r) {
  return {16, static_cast<std::uint8_t>(r.address >> 8), static_cast<std::uint8_t>(r.address),
          static_cast<std::uint8_t>(r.count >> 8), static_cast<std::uint8_t>(r.count)};
}
inline Bytes exception_answer(std::uint8_t function, std::uint8_t code) {
  return {static_cast<std::uint8_t>(function | 0x80), code};
}
inline std::uint16_t modbus_crc(const Bytes& bytes) {
  unsigned crc = 0xFFFF;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1) != 0 ? crc >> 1 ^ 0xA001 : crc >> 1;
  }
  return static_cast<std::uint16_t>(crc);
}

class ModbusServer {
 public:
  /// Both are called on the server's thread. An answer may take its time, or be nothing; a spoil
  /// changes the frame as it goes over the wire.
  using Answer = std::function<std::optional<Bytes>(const ModbusRequest&)>;
  using Spoil = std::function<void(Bytes& frame)>;

  /// On 127.0.0.1; port 0 chooses one.
  static std::unique_ptr<ModbusServer> tcp(Answer answer, Spoil spoil, std::uint16_t port = 0) {
    const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const int yes = 1;
    setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_port = htons(port);
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof at;
    if (bind(fd, reinterpret_cast<sockaddr*>(&at), size) != 0 || listen(fd, 4) != 0 ||
        getsockname(fd, reinterpret_cast<sockaddr*>(&at), &size) != 0) {
      std::abort();
    }
    auto server =
        std::unique_ptr<ModbusServer>(new ModbusServer(std::move(answer), std::move(spoil)));
    server->listener_ = fd;
    server->port_ = ntohs(at.sin_port);
    server->thread_ = std::thread([s = server.get()] { s->serve_tcp(); });
    return server;
  }
  /// On the master's end of a pseudo-terminal, which must outlive the server.
  static std::unique_ptr<ModbusServer> rtu(Answer answer, Spoil spoil, int fd) {
    auto server =
        std::unique_ptr<ModbusServer>(new ModbusServer(std::move(answer), std::move(spoil)));
    server->thread_ = std::thread([s = server.get(), fd] { s->serve_rtu(fd); });
    return server;
  }
  ~ModbusServer() {
    stopped_ = true;
    thread_.join();
    if (listener_ >= 0) close(listener_);
  }

  /// As some gateways do.
  std::atomic<bool> closes_after_each{false};
  /// As an adapter does that hears what the host sends; RTU only.
  std::atomic<bool> echoes{false};

  std::uint16_t port() const { return port_; }
  int requests() const { return requests_; }

 private:
  ModbusServer(Answer answer, Spoil spoil) : answer_(std::move(answer)), spoil_(std::move(spoil)) {}

  bool wait(int fd) const {
    pollfd ready{fd, POLLIN, 0};
    while (!stopped_) {
      if (poll(&ready, 1, 5) > 0) return (ready.revents & POLLIN) != 0;
    }
    return false;
  }
  bool read_exactly(int fd, Bytes& into, std::size_t more) const {
    while (more > 0) {
      if (!wait(fd)) return false;
      std::uint8_t byte = 0;
      if (::read(fd, &byte, 1) != 1) return false;
      into.push_back(byte);
      --more;
    }
    return true;
  }
  /// The rest of a request whose function code is the last byte read.
  bool read_request(int fd, Bytes& frame, ModbusRequest& r) const {
    const std::size_t start = frame.size();
    r.function = frame.back();
    if (!read_exactly(fd, frame, 4)) return false;
    const auto word = [&](std::size_t at) {
      return static_cast<std::uint16_t>(frame[at] << 8 | frame[at + 1]);
    };
    r.address = word(start);
    r.count = word(start + 2);
    if (r.function != 16) return true;
    if (!read_exactly(fd, frame, 1 + std::size_t{2} * r.count)) return false;
    for (std::size_t i = 0; i < r.count; ++i) r.values.push_back(word(start + 5 + 2 * i));
    return true;
  }
  void send(int fd, Bytes frame) {
    spoil_(frame);
    if (::write(fd, frame.data(), frame.size()) < 0) return;  // the client has gone
  }
  void serve_tcp() {
    while (wait(listener_)) {
      const int fd = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
      for (;;) {
        Bytes frame;
        ModbusRequest request;
        if (!read_exactly(fd, frame, 8) || !read_request(fd, frame, request)) break;
        request.unit = frame[6];
        ++requests_;
        const auto pdu = answer_(request);
        if (!pdu) continue;
        Bytes out{frame[0], frame[1], 0, 0, 0, static_cast<std::uint8_t>(pdu->size() + 1),
                  frame[6]};
        out.insert(out.end(), pdu->begin(), pdu->end());
        // Where the client has closed, a write must not raise SIGPIPE.
        spoil_(out);
        ::send(fd, out.data(), out.size(), MSG_NOSIGNAL);
        if (closes_after_each) break;
      }
      close(fd);
    }
  }
  void serve_rtu(int fd) {
    while (!stopped_) {
      Bytes frame;
      ModbusRequest request;
      if (!read_exactly(fd, frame, 2) || !read_request(fd, frame, request) ||
          !read_exactly(fd, frame, 2)) {
        continue;
      }
      request.unit = frame[0];
      ++requests_;
      if (echoes && ::write(fd, frame.data(), frame.size()) < 0) continue;
      const auto pdu = answer_(request);
      if (!pdu) continue;
      Bytes out{frame[0]};
      out.insert(out.end(), pdu->begin(), pdu->end());
      const std::uint16_t crc = modbus_crc(out);
      out.push_back(static_cast<std::uint8_t>(crc));
      out.push_back(static_cast<std::uint8_t>(crc >> 8));
      send(fd, out);
    }
  }

  Answer answer_;
  Spoil spoil_;
  int listener_ = -1;
  std::uint16_t port_ = 0;
  std::atomic<bool> stopped_{false};
  std::atomic<int> requests_{0};
  std::thread thread_;
};

}  // namespace fogbench::support
