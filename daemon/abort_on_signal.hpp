#pragma once
// SIGINT and SIGTERM ask the engine to abort: the bench is driven to its safe state and the record
// says so. A second one ends the process at once. SIGPIPE is ignored from then on.

#include "procedures/run_engine.hpp"

namespace fogbench::daemon {

/// At most one at a time; the engine must outlive it.
class AbortOnSignal {
 public:
  explicit AbortOnSignal(procedures::RunEngine& engine);
  AbortOnSignal(const AbortOnSignal&) = delete;
  AbortOnSignal& operator=(const AbortOnSignal&) = delete;
  ~AbortOnSignal();

  /// True when a signal has come.
  static bool asked();
};

}  // namespace fogbench::daemon
