#pragma once
// Many clients of one control socket, each asking for the status again and again, from one thread.

#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <string>
#include <vector>

#include "drivers/file_descriptor.hpp"

namespace fogbench::test {

class PollingClients {
 public:
  using Clock = std::chrono::steady_clock;

  /// Fewer than `count` when the server takes no more.
  PollingClients(const std::string& socket, std::size_t count) {
    rlimit files{};
    getrlimit(RLIMIT_NOFILE, &files);
    files.rlim_cur = files.rlim_max;
    setrlimit(RLIMIT_NOFILE, &files);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    socket.copy(address.sun_path, sizeof address.sun_path - 1);
    for (std::size_t i = 0; i < count; ++i) {
      const Client& client = clients_.emplace_back();
      const int fd = client.socket.get();
      if (connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
        clients_.pop_back();
        break;
      }
    }
  }

  std::size_t connected() const { return clients_.size(); }

  /// Each client asks every `period`, spread over it, for `duration`.
  void poll_for(std::chrono::milliseconds duration, std::chrono::milliseconds period) {
    const auto begun = Clock::now();
    for (std::size_t i = 0; i < clients_.size(); ++i) {
      clients_[i].due = begun + period * i / clients_.size();
    }
    while (Clock::now() < begun + duration) {
      const auto now = Clock::now();
      std::vector<pollfd> waiting;
      for (Client& client : clients_) {
        if (!client.asked && client.due <= now) ask(client);
        waiting.push_back({client.socket.get(), client.asked ? short{POLLIN} : short{0}, 0});
      }
      if (::poll(waiting.data(), waiting.size(), 1) < 0) return;
      for (std::size_t i = 0; i < waiting.size(); ++i) {
        if ((waiting[i].revents & POLLIN) != 0) take(clients_[i], period);
      }
    }
  }

  std::size_t answers() const { return latencies_ms_.size(); }
  /// Of the requests that were answered; `share` 0.5 is the median.
  double latency_ms(double share) {
    if (latencies_ms_.empty()) return 0.0;
    std::sort(latencies_ms_.begin(), latencies_ms_.end());
    const auto last = static_cast<double>(latencies_ms_.size() - 1);
    return latencies_ms_[static_cast<std::size_t>(share * last)];
  }

 private:
  struct Client {
    drivers::FileDescriptor socket{::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)};
    Clock::time_point due, asked_at;
    bool asked = false;
  };

  static void ask(Client& client) {
    static constexpr char kRequest[] = "{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"status\"}\n";
    client.asked_at = Clock::now();
    client.asked = send(client.socket.get(), kRequest, sizeof kRequest - 1, MSG_NOSIGNAL) > 0;
  }
  void take(Client& client, std::chrono::milliseconds period) {
    char answer[16384];
    const ssize_t got = recv(client.socket.get(), answer, sizeof answer, MSG_DONTWAIT);
    if (got <= 0 || answer[got - 1] != '\n') return;
    const std::chrono::duration<double, std::milli> took = Clock::now() - client.asked_at;
    latencies_ms_.push_back(took.count());
    client.asked = false;
    client.due = client.asked_at + period;
  }

  std::deque<Client> clients_;  // none of them moves
  std::vector<double> latencies_ms_;
};

}  // namespace fogbench::test
