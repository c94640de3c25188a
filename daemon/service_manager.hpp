#pragma once
// What systemd is told of a service of Type=notify: that it is ready, a line about the bench, that
// it stops, and that it is alive (WatchdogSec=). On the control socket's thread.
//
// The watchdog is fed from here, but for the bench's thread: only when that has advanced since the
// last time, waits for a job, or is being aborted, which has a deadline of its own (kAbortTime). A
// call into an instrument that never returns starves it. Without systemd all of this is nothing.

#include <optional>
#include <string>

#include "daemon/run_desk.hpp"
#include "drivers/clock.hpp"

namespace fogbench::daemon {

class ServiceManager {
 public:
  /// The clock is the machine's.
  explicit ServiceManager(drivers::Clock& clock);

  /// What can be reached of the bench is safe, and the socket is served.
  void ready();
  /// To be called several times a second.
  void report(const RunDesk& desk);

 private:
  drivers::Clock& clock_;
  std::optional<drivers::Clock::Duration> watchdog_;  ///< nothing: it is off
  drivers::Clock::Duration period_;
  drivers::Clock::Instant due_ = drivers::Clock::Instant::min();
  std::uint64_t fed_at_ = 0;  ///< the pulse's beats at the last feeding
  std::string said_;
  bool stopping_ = false;
};

/// One line: "run 7, coil-sweep: running, step 5 of 82, 3 h 50 min left".
std::string service_status(const DeskView& view);

}  // namespace fogbench::daemon
