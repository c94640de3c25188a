#pragma once
// Keeps the way to an instrument that may be unplugged and plugged in again: what all ports share.
//
//   open ── lost() ──► gone ── get(), when a try is due ──► open, or gone for twice as long
//
// The first try is made at once, the next ones after 0.1 s, 0.2 s, 0.4 s ... at most 1 s, so that a
// call to a missing instrument costs little and its return is noticed within a second.

#include <algorithm>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>

#include "config/result.hpp"
#include "drivers/clock.hpp"

namespace fogbench::drivers {

template <class Handle>
class Reconnecting {
 public:
  using Open = std::function<Result<std::unique_ptr<Handle>>()>;

  /// `clock` must outlive it. Nothing is opened yet.
  Reconnecting(Clock& clock, Open open) : clock_(clock), open_(std::move(open)) {}

  /// The handle, opened when it is not. An error is the last try's, as kUnplugged unless another
  /// process has the instrument (kHeld). The pointer is valid until lost().
  Result<Handle*> get() {
    if (handle_) return handle_.get();
    if (clock_.now() < next_try_) return last_;
    auto opened = open_();
    if (!opened) {
      const bool held = opened.error().code == ErrorCode::kHeld;
      last_ = {held ? ErrorCode::kHeld : ErrorCode::kUnplugged, opened.error().message};
      next_try_ = clock_.now() + pause_;
      pause_ = std::min(2 * pause_, kLongestPause);
      return last_;
    }
    const std::lock_guard lock(last_words_);
    handle_ = std::move(*opened);
    pause_ = kFirstPause;
    return handle_.get();
  }

  /// Forgets the handle: the instrument is gone, or nothing that comes from it can be trusted.
  void lost() {
    const std::lock_guard lock(last_words_);
    handle_.reset();
  }

  /// Any thread: `say` with the handle, if it is open, while nobody closes it.
  template <class Say>
  void last_words(Say say) {
    const std::lock_guard lock(last_words_);
    if (handle_) say(*handle_);
  }

 private:
  static constexpr Clock::Duration kFirstPause = std::chrono::milliseconds{100};
  static constexpr Clock::Duration kLongestPause = std::chrono::seconds{1};

  Clock& clock_;
  Open open_;
  std::mutex last_words_;  ///< held while handle_ changes
  std::unique_ptr<Handle> handle_;
  Error last_{ErrorCode::kUnplugged, ""};
  Clock::Instant next_try_{Clock::Instant::min()};
  Clock::Duration pause_ = kFirstPause;
};

}  // namespace fogbench::drivers
