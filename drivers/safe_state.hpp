#pragma once
// The safe state of a bench: every supply at 0 A, every heater off, each read back.

#include <span>
#include <string>
#include <vector>

#include "config/result.hpp"
#include "drivers/instruments.hpp"

namespace fogbench::drivers {

/// How far one actuator came.
struct Safety {
  enum class State {
    kReadBack,     ///< switched off, and it says so
    kCommanded,    ///< told to switch off; it did not confirm it
    kUnreachable,  ///< not told
  };
  std::string actuator;
  State state = State::kUnreachable;
  std::string failure;  ///< the last; empty when it was read back
};

struct SafetyReport {
  std::vector<Safety> actuators;

  bool reached() const;
  /// Each actuator with its state, in one line.
  std::string text() const;
  /// kDevice, with every actuator that is not confirmed.
  Status status() const;
};

/// All actuators are told before any is waited for; then each is asked, and those that do not
/// confirm are told again, in rounds: one that is absent or silent costs the others none of its
/// time-outs. Nothing is asked for but that it is off: the one routine for abort, fault, signal,
/// start, and the normal end. Null actuators are left out.
SafetyReport make_safe(const Bench& bench);
/// The same for the coils alone.
SafetyReport coils_off(const Bench& bench);

}  // namespace fogbench::drivers
