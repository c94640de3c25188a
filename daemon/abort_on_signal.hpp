#pragma once
// A program that runs procedures in the foreground, and the signals that stop it
// (stop_signals.hpp): the first one has the engine abort, so that the bench is driven to its safe
// state and the record says so. A later one ends the process at once, with 0 A to the coils as its
// last words.

#include <atomic>
#include <mutex>
#include <thread>

#include "daemon/session.hpp"
#include "daemon/stop_signals.hpp"
#include "drivers/clock.hpp"
#include "drivers/file_descriptor.hpp"

namespace fogbench::daemon {

/// Made before the bench is touched: a signal that comes while it opens is not lost. Its thread is
/// "signals".
class AbortOnSignal {
 public:
  AbortOnSignal();
  AbortOnSignal(const AbortOnSignal&) = delete;
  AbortOnSignal& operator=(const AbortOnSignal&) = delete;
  ~AbortOnSignal();

  /// The session whose engine aborts; it must outlive this. One that came too late for a signal is
  /// asked to abort at once.
  void attach(Session& session);
  /// True when a signal has come.
  bool asked() const { return asked_; }

 private:
  void watch();
  void take(const StopSignals::Signal& signal);

  drivers::SteadyClock clock_;
  StopSignals signals_;
  drivers::FileDescriptor end_;
  std::atomic<bool> asked_{false};
  std::mutex mutex_;
  Session* session_ = nullptr;
  std::thread thread_;
};

/// Ends the process, exit status 4, the bench not known to be safe: says why, and sends the coils
/// 0 A without waiting. `session` may be null.
[[noreturn]] void end_at_once(const std::string& why, Session* session);

}  // namespace fogbench::daemon
