#pragma once
// How long an operation on a physical line may take. The kernel waits in the machine's time, so
// this does too, whatever the bench's clock shows.

#include <algorithm>
#include <chrono>

#include "drivers/clock.hpp"

namespace fogbench::drivers {

class Deadline {
 public:
  explicit Deadline(Clock::Duration timeout) : at_(clock_.now() + timeout) {}

  bool passed() const { return clock_.now() >= at_; }
  /// Never negative.
  Clock::Duration left() const { return std::max(at_ - clock_.now(), Clock::Duration::zero()); }
  /// As poll() and the libraries take it, rounded up; 0 only when the deadline has passed, and
  /// never more than a day, which they can count.
  int left_ms() const {
    constexpr Clock::Duration kLongest = std::chrono::hours{24};
    const auto ms = std::chrono::ceil<std::chrono::milliseconds>(std::min(left(), kLongest));
    return static_cast<int>(ms.count());
  }

 private:
  SteadyClock clock_;
  Clock::Instant at_;
};

}  // namespace fogbench::drivers
