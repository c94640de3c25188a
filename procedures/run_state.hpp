#pragma once
// The run engine's life as data. What the table does not list is refused.

#include <optional>
#include <string_view>

#include "procedures/run_engine.hpp"

namespace fogbench::procedures {

enum class RunEvent {
  kStart,
  kPause,
  kResume,
  kDone,      ///< the last step has ended
  kAbort,     ///< asked for by a person or a signal
  kFail,      ///< a step has failed
  kSafeDone,  ///< the bench is safe, or as safe as it could be made, after kDone
  kSafeAborted,
  kSafeFailed,
};

/// Nothing when the event is refused in that state.
std::optional<RunState> next_state(RunState state, RunEvent event);

std::string_view name_of(RunState state);

}  // namespace fogbench::procedures
