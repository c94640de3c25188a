#pragma once
// Carries lines between the control socket's clients and a ControlService. One thread, never
// blocked by a client, and bounded in everything that a client can make it keep:
//
//   a line            kLongestRequest; a longer one is answered with an error and the end
//   half a line       kHalfLineTime; then the client is dropped
//   answers unread    kMostUnread and one answer more; until they are read no request of this
//                     client is, and after kUnreadTime without progress the client is dropped
//   news unread       one; a client that does not read misses what came between
//   connections       kMostConnections, the last kForOperators of them for operators, at most
//                     kMostPerUser for a user who is none

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "config/result.hpp"
#include "daemon/access.hpp"
#include "drivers/clock.hpp"
#include "drivers/file_descriptor.hpp"

namespace fogbench::daemon {

/// What a client has subscribed to.
struct Subscription {
  drivers::Clock::Duration every{};
  std::string pattern_json;           ///< the shape that its news take; empty: all there is
  std::optional<std::uint64_t> seen;  ///< version of the desk's view that was sent last
  drivers::Clock::Instant due{};
};

struct Caller {
  uid_t uid = 0;
  Role role = Role::kNobody;
  std::optional<Subscription> subscription;
  std::vector<gid_t> groups;
};

/// What the lines mean. Called on the server's thread, and returns soon.
class ControlService {
 public:
  virtual ~ControlService() = default;
  /// The answer with its newline; empty when there is none to send.
  virtual std::string answer(std::string_view line, Caller& caller) = 0;
  /// For a caller whose subscription is due; empty when there is nothing new.
  virtual std::string news(Caller& caller) = 0;
};

class ControlServer {
 public:
  static constexpr std::size_t kMostUnread = 65536;
  static constexpr std::size_t kMostConnections = 1500;
  static constexpr std::size_t kForOperators = 100;
  static constexpr std::size_t kMostPerUser = 100;
  static constexpr std::chrono::seconds kHalfLineTime{10};
  static constexpr std::chrono::seconds kUnreadTime{10};

  /// `listening` and `wake` are non-blocking descriptors; all must outlive the server.
  /// The clock is the machine's.
  ControlServer(int listening, int wake, const AccessRules& rules, ControlService& service,
                drivers::Clock& clock);
  ~ControlServer();

  /// One round: waits for something to do, at most kLongestWait, or until `wake` can be read, and
  /// does it.
  void serve_once();
  std::size_t connections() const { return clients_.size(); }
  /// How many were one too many, since the start.
  std::uint64_t refused() const { return refused_; }

 private:
  static constexpr std::chrono::milliseconds kLongestWait{200};
  static constexpr std::chrono::milliseconds kSubscriptionWait{20};

  struct Client;
  void accept_clients();
  /// Why it may not come in; null when it may.
  std::optional<std::string> refusal(const Credentials& peer, Role role) const;
  void read_from(Client& client);
  void answer_lines(Client& client);
  void send_news(Client& client);
  static void write_to(Client& client, drivers::Clock::Instant now);
  bool outlived(const Client& client) const;

  int listening_, wake_;
  AccessRules rules_;
  ControlService& service_;
  drivers::Clock& clock_;
  std::vector<std::unique_ptr<Client>> clients_;
  std::uint64_t refused_ = 0;
  /// Out of file handles: not before then.
  drivers::Clock::Instant accept_again_ = drivers::Clock::Instant::min();
};

}  // namespace fogbench::daemon
