#pragma once
// The signals that end a process with a bench: SIGTERM, SIGINT, and SIGHUP unless nohup asked to
// survive it. They are read from a descriptor, never handled where they strike: what is done about
// them may log, lock and speak to instruments.
//
//   first    abort to the safe state, then the end
//   again    within kPatience it is the same event: a closed terminal tells both kernel and shell,
//            and `timeout` and systemd tell a process and its group. Later it is a person who
//            will not wait: the forced end

#include <chrono>
#include <csignal>
#include <optional>
#include <string>

#include "drivers/clock.hpp"
#include "drivers/file_descriptor.hpp"

namespace fogbench::daemon {

class StopSignals {
 public:
  /// A safe state takes a second or two; nobody repeats an order sooner.
  static constexpr drivers::Clock::Duration kPatience = std::chrono::seconds{3};

  enum class Means { kAbort, kSameEvent, kForcedEnd };
  struct Signal {
    std::string name;  ///< "SIGTERM"
    Means means = Means::kAbort;
  };

  /// From here on they are read from the descriptor, in all threads that are started later, too.
  /// SIGPIPE and SIGXFSZ are ignored: a write that fails says so itself. `clock` is the machine's.
  explicit StopSignals(drivers::Clock& clock);
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;
  /// They act as they did before.
  ~StopSignals();

  /// Readable when one has come.
  int descriptor() const { return descriptor_.get(); }
  /// None when none has come. One thread at a time.
  std::optional<Signal> next();

 private:
  drivers::Clock& clock_;
  sigset_t before_{};
  drivers::FileDescriptor descriptor_;
  std::optional<drivers::Clock::Instant> first_;
};

}  // namespace fogbench::daemon
