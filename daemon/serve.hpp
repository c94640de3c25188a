#pragma once
// fogbenchd as a service: the bench in its safe state first, then procedures from the queue, one
// after the other, while the control socket answers.
//
// Two threads. The one that calls serve() serves the socket and takes signals; the other one, which
// serve() starts and joins, runs the engine. They share the RunDesk.
//
// The stop ladder, each rung from the socket or by a signal:
//
//   pause    at the next divisible step; the bench holds what it has
//   abort    safe state now, read back; the record says aborted. SIGTERM, SIGINT, SIGHUP: abort,
//            then the process ends
//   forced   the process ends at once, its last words 0 A to the coils, which nobody waits for: a
//            second signal that comes StopSignals::kPatience after the first or later, `abort` with
//            force, or an abort that has not reached the safe state within kAbortTime. Whoever
//            supervises the daemon starts it again, and a start begins with the safe state.
//
// A start switches off what it can reach before anything else is opened or judged. While an
// instrument is missing the daemon serves, says so, and goes on trying: jobs wait for it.

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>

#include "config/result.hpp"
#include "daemon/session.hpp"

namespace fogbench::daemon {

/// An instrument that is silent is given up after 30 s (BenchWatch), and the safe state then tries
/// each one several times.
inline constexpr std::chrono::seconds kAbortTime{120};

struct ServeOptions {
  std::string socket;     ///< empty: the default place, or systemd's
  std::string operators;  ///< name of the group whose members may act; empty: none
  std::string observers;  ///< name of the group whose members may read; empty: see AccessRules
  std::string metrics;    ///< file that holds them; empty: none
  drivers::Clock::Duration abort_time = kAbortTime;
};

/// Returns after a signal, the bench in its safe state. Errors: kUsage for a virtual clock, which
/// waits for nobody; kBadInput for a group or a path; kStore; kDevice for an instrument that
/// another program has, or when the bench could not be made safe.
Status serve(Setup setup, std::uint64_t seed, const std::filesystem::path& store, Speed speed,
             const ServeOptions& options);

}  // namespace fogbench::daemon
