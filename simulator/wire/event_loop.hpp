#pragma once
// One thread serves every instrument. Before each turn every server says what it waits for
// (descriptors and an instant); after it, each looks what has come.

#include <poll.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "config/result.hpp"
#include "drivers/clock.hpp"

namespace fogbench::simulator {

/// What a turn waits for, and then what has happened.
class PollSet {
 public:
  using Instant = drivers::Clock::Instant;

  /// `events`: POLLIN, POLLOUT.
  void add(int descriptor, short events) { all_.push_back({descriptor, events, 0}); }
  void wake_at(Instant instant) { wake_at_ = std::min(wake_at_, instant); }

  /// What happened on it; 0 when nothing, or when it was not waited for.
  short happened(int descriptor) const {
    for (const pollfd& one : all_) {
      if (one.fd == descriptor) return one.revents;
    }
    return 0;
  }

  Instant wake_at() const { return wake_at_; }
  std::vector<pollfd>& descriptors() { return all_; }

 private:
  std::vector<pollfd> all_;
  Instant wake_at_ = Instant::max();
};

class Server {
 public:
  Server() = default;
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;
  virtual ~Server() = default;
  virtual void enlist(PollSet& set) const = 0;
  /// Never blocks.
  virtual void serve(const PollSet& happened) = 0;
};

/// Runs until `stop` is readable. `speed`: bench seconds of the clock in one of the machine's.
/// kDevice when the machine cannot wait any more.
Status run_event_loop(const std::vector<std::unique_ptr<Server>>& servers,
                      const drivers::Clock& clock, double speed, int stop);

}  // namespace fogbench::simulator
