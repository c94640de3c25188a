#pragma once
// A clock on which sleeping is put on record instead. A far end takes its time by sleeping; on this
// clock its call returns at once, and the server holds the answer back until take_due(). So one
// thread serves all instruments, and a slow one holds up none of the others.

#include <algorithm>
#include <utility>

#include "drivers/clock.hpp"

namespace fogbench::simulator {

class DeferringClock final : public drivers::Clock {
 public:
  /// `machine` must outlive this clock.
  explicit DeferringClock(const drivers::Clock& machine) : machine_(machine) {}

  Instant now() const override { return machine_.now(); }
  WallTime wall_now() const override { return machine_.wall_now(); }
  void sleep_until(Instant deadline) override { due_ = std::max(due_, deadline); }

  /// When the last call of a far end would have returned; not before the present.
  Instant take_due() { return std::max(now(), std::exchange(due_, Instant{})); }

 private:
  const drivers::Clock& machine_;
  Instant due_{};
};

}  // namespace fogbench::simulator
