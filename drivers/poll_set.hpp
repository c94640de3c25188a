#pragma once
// Whoever serves several descriptors from one loop waits with this.

#include <poll.h>

#include <vector>

#include "drivers/clock.hpp"

namespace fogbench::drivers {

/// What a turn waits for, and then what has happened.
class PollSet {
 public:
  using Instant = Clock::Instant;

  /// `events`: POLLIN, POLLOUT.
  void add(int descriptor, short events) { all_.push_back({descriptor, events, 0}); }
  void wake_at(Instant instant) { wake_at_ = std::min(wake_at_, instant); }

  /// Until something happens, for so long of the machine's time at most. A signal ends it with
  /// nothing happened. False, with the reason in errno, when the machine cannot wait.
  bool wait(std::chrono::nanoseconds at_most);

  /// What happened on it; 0 when nothing, or when it was not waited for.
  short happened(int descriptor) const;
  Instant wake_at() const { return wake_at_; }

 private:
  std::vector<pollfd> all_;
  Instant wake_at_ = Instant::max();
};

}  // namespace fogbench::drivers
