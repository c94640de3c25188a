#include "daemon/control_server.hpp"

#include <fmt/format.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "daemon/json_rpc.hpp"
#include "drivers/poll_set.hpp"

namespace fogbench::daemon {
namespace {

using Instant = drivers::Clock::Instant;

/// A stranger in a crowd must not keep the others waiting.
constexpr int kMostAcceptedAtOnce = 64;

bool later() {
  return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
}

}  // namespace

struct ControlServer::Client {
  Client(int fd, Caller who) : socket(fd), caller(std::move(who)) {}

  drivers::FileDescriptor socket;
  Caller caller;
  std::string in, out;
  Instant half_since = Instant::max();    ///< when the line under way began; max: none has
  Instant unread_since = Instant::max();  ///< of the last progress in sending; max: all is sent
  bool last_words = false;                ///< closed when `out` has been sent
  bool gone = false;
};

ControlServer::ControlServer(int listening, int wake, const AccessRules& rules,
                             ControlService& service, drivers::Clock& clock)
    : listening_(listening), wake_(wake), rules_(rules), service_(service), clock_(clock) {}

ControlServer::~ControlServer() = default;

void ControlServer::serve_once() {
  const bool accepting = clock_.now() >= accept_again_;
  drivers::PollSet files;
  files.add(wake_, POLLIN);
  if (accepting) files.add(listening_, POLLIN);
  bool subscribed = false;
  for (const auto& client : clients_) {
    files.add(client->socket.get(), client->out.empty() ? POLLIN : POLLOUT);
    subscribed = subscribed || client->caller.subscription;
  }
  const auto wait = subscribed ? kSubscriptionWait : kLongestWait;
  if (!files.wait(wait)) {
    // No memory, or fewer handles allowed than there are: asking again at once would do nothing
    // else.
    clock_.sleep_for(kLongestWait);
    return;
  }

  for (const auto& each : clients_) {
    Client& client = *each;
    const short seen = files.happened(client.socket.get());
    if ((seen & POLLIN) != 0) {
      read_from(client);
    } else if ((seen & (POLLERR | POLLHUP | POLLNVAL)) != 0) {
      client.gone = true;
    }
    if ((seen & POLLOUT) != 0) write_to(client, clock_.now());
    answer_lines(client);
    send_news(client);
    if (outlived(client)) client.gone = true;
  }
  std::erase_if(clients_, [](const auto& client) { return client->gone; });
  if ((files.happened(listening_) & POLLIN) != 0) accept_clients();
}

void ControlServer::accept_clients() {
  for (int i = 0; i < kMostAcceptedAtOnce; ++i) {
    const int accepted = accept4(listening_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (accepted < 0) {
      // Out of file handles or memory: those who are here go on.
      if (!later() && errno != ECONNABORTED) accept_again_ = clock_.now() + std::chrono::seconds{1};
      return;
    }
    const auto peer = credentials_of(accepted);
    const Role role = peer ? rules_.role_of(*peer) : Role::kNobody;
    const Credentials who = peer ? *peer : Credentials{};
    auto client = std::make_unique<Client>(accepted, Caller{who.uid, role, {}, who.groups});
    if (!peer) continue;
    if (const auto why = refusal(*peer, role)) {
      ++refused_;
      const std::string answer = format_error("null", {RpcCode::kTooManyConnections, *why});
      // One attempt: nobody waits for a client that is sent away.
      (void)send(accepted, answer.data(), answer.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
      continue;
    }
    clients_.push_back(std::move(client));
  }
}

std::optional<std::string> ControlServer::refusal(const Credentials& peer, Role role) const {
  if (clients_.size() >= kMostConnections) {
    return fmt::format("{} connections are open, the most there may be", kMostConnections);
  }
  if (role == Role::kOperator) return std::nullopt;
  if (clients_.size() >= kMostConnections - kForOperators) {
    return std::string("the last free connections are for operators");
  }
  const auto same = std::count_if(clients_.begin(), clients_.end(),
                                  [&](const auto& c) { return c->caller.uid == peer.uid; });
  if (static_cast<std::size_t>(same) < kMostPerUser) return std::nullopt;
  return fmt::format("this user has {} connections open, the most one may have", kMostPerUser);
}

void ControlServer::read_from(Client& client) {
  char buffer[4096];
  const ssize_t count = recv(client.socket.get(), buffer, sizeof buffer, 0);
  if (count > 0) {
    if (client.in.empty()) client.half_since = clock_.now();
    client.in.append(buffer, static_cast<std::size_t>(count));
  } else if (count == 0 || !later()) {
    client.gone = true;
  }
}

void ControlServer::answer_lines(Client& client) {
  std::size_t begin = 0;
  while (!client.gone && !client.last_words && client.out.size() < kMostUnread) {
    const std::size_t end = client.in.find('\n', begin);
    if (end == std::string::npos) break;
    const auto line = std::string_view(client.in).substr(begin, end - begin);
    if (line.size() >= kLongestRequest) break;
    begin = end + 1;
    // An empty line keeps a connection alive and means nothing.
    if (!line.empty()) client.out += service_.answer(line, client.caller);
    // What can be sent at once makes room for the next answer.
    write_to(client, clock_.now());
  }
  client.in.erase(0, begin);
  if (begin > 0) client.half_since = client.in.empty() ? Instant::max() : clock_.now();
  if (client.in.size() >= kLongestRequest && !client.last_words &&
      client.in.find('\n') >= kLongestRequest) {
    client.last_words = true;
    client.out += format_error(
        "null",
        {RpcCode::kTooLong,
         fmt::format("a request of more than {} bytes, its newline included", kLongestRequest)});
    client.in.clear();
    write_to(client, clock_.now());
  }
}

void ControlServer::send_news(Client& client) {
  auto& subscription = client.caller.subscription;
  if (!subscription || client.gone || client.last_words || !client.out.empty()) return;
  const Instant now = clock_.now();
  if (now < subscription->due) return;
  client.out += service_.news(client.caller);
  subscription->due = now + subscription->every;
  write_to(client, now);
}

void ControlServer::write_to(Client& client, Instant now) {
  while (!client.out.empty() && !client.gone) {
    const ssize_t sent =
        send(client.socket.get(), client.out.data(), client.out.size(), MSG_NOSIGNAL);
    if (sent > 0) {
      client.out.erase(0, static_cast<std::size_t>(sent));
      client.unread_since = now;
    } else if (later()) {
      if (client.unread_since == Instant::max()) client.unread_since = now;
      return;
    } else {
      client.gone = true;
    }
  }
  client.unread_since = Instant::max();
  if (client.last_words) client.gone = true;
}

bool ControlServer::outlived(const Client& client) const {
  const Instant now = clock_.now();
  const auto since = [now](Instant then) {
    return then == Instant::max() ? drivers::Clock::Duration::zero() : now - then;
  };
  // A line that waits for answers to be read is not the client's half line.
  const bool half = client.out.empty() && since(client.half_since) > kHalfLineTime;
  return half || since(client.unread_since) > kUnreadTime;
}

}  // namespace fogbench::daemon
