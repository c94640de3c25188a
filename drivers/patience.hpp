#pragma once
// How often and how long an instrument is asked again: the one place that knows. A refusal is
// final. What was lost or garbled on the way is put again at once, a bounded number of times. An
// instrument that is busy is asked again until the time is over, with a pause between two tries.

#include <fmt/format.h>

#include <chrono>

#include "config/result.hpp"
#include "drivers/clock.hpp"

namespace fogbench::drivers {

class Patience {
 public:
  /// A reading is missed once, and there is another one a second later.
  static constexpr Clock::Duration kForReading = std::chrono::seconds{1};
  /// A command that is given up ends a run, so a controller may store its settings, and a gateway
  /// have its own time-outs, several times over. Nothing else on the bench is looked after
  /// meanwhile.
  static constexpr Clock::Duration kForCommand = std::chrono::seconds{10};

  /// Counts from now. `clock` must outlive it.
  Patience(Clock& clock, Clock::Duration longest)
      : clock_(clock), begun_(clock.now()), longest_(longest) {}

  /// Whether to ask again after this error; where a pause is due it has been made.
  bool again(const Error& error) {
    if (may_be_lost(error)) return ++lost_ < kMostLost;
    return again_if_busy(error);
  }
  /// The same for what may not be said twice when its outcome is unknown.
  bool again_if_busy(const Error& error) {
    if (error.code != ErrorCode::kBusy) return false;
    if (clock_.now() + kPause > begun_ + longest_) return false;
    clock_.sleep_for(kPause);
    return true;
  }

  /// For as long as this one.
  Patience for_another_question() const {
    Patience another = *this;
    another.lost_ = 0;
    return another;
  }

  /// The error when it is given up: a busy instrument's says for how long it was asked.
  Error given_up(const Error& error) const {
    if (error.code != ErrorCode::kBusy) return error;
    return {error.code,
            fmt::format("{}, for {:.1f} s", error.message, to_seconds(clock_.now() - begun_))};
  }

  /// Lost or garbled on the way: its outcome is unknown. A connection that the other side has
  /// closed is made anew at once.
  static bool may_be_lost(const Error& error) {
    return error.code == ErrorCode::kTimeout || error.code == ErrorCode::kProtocol ||
           error.code == ErrorCode::kUnplugged;
  }

 private:
  static constexpr int kMostLost = 3;
  /// A gateway that is asked more often gets busier.
  static constexpr Clock::Duration kPause = std::chrono::milliseconds{100};

  Clock& clock_;
  Clock::Instant begun_;
  Clock::Duration longest_;
  int lost_ = 0;
};

/// Asks until there is an answer, a refusal, or no patience left. Several questions may share one
/// patience's time; what is lost is counted for each by itself.
template <class Ask>
auto ask_again(const Patience& shared, Ask ask) -> decltype(ask()) {
  Patience patience = shared.for_another_question();
  for (;;) {
    auto outcome = ask();
    if (outcome) return outcome;
    if (!patience.again(outcome.error())) return patience.given_up(outcome.error());
  }
}

/// The same for what may not be said twice when its outcome is unknown.
template <class Ask>
auto ask_while_busy(Patience patience, Ask ask) -> decltype(ask()) {
  for (;;) {
    auto outcome = ask();
    if (outcome) return outcome;
    if (!patience.again_if_busy(outcome.error())) return patience.given_up(outcome.error());
  }
}

}  // namespace fogbench::drivers
