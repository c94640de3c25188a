#include "procedures/run_state.hpp"

#include <array>

namespace fogbench::procedures {
namespace {

struct Transition {
  RunState from;
  RunEvent event;
  RunState to;
};

constexpr Transition kTransitions[] = {
    {RunState::kIdle, RunEvent::kStart, RunState::kRunning},
    {RunState::kRunning, RunEvent::kPause, RunState::kPaused},
    {RunState::kPaused, RunEvent::kResume, RunState::kRunning},
    {RunState::kRunning, RunEvent::kDone, RunState::kStopping},
    {RunState::kRunning, RunEvent::kAbort, RunState::kStopping},
    {RunState::kRunning, RunEvent::kFail, RunState::kStopping},
    {RunState::kPaused, RunEvent::kAbort, RunState::kStopping},
    {RunState::kPaused, RunEvent::kFail, RunState::kStopping},
    {RunState::kStopping, RunEvent::kSafeDone, RunState::kCompleted},
    {RunState::kStopping, RunEvent::kSafeAborted, RunState::kAborted},
    {RunState::kStopping, RunEvent::kSafeFailed, RunState::kFailed},
    // An engine may run again after an end.
    {RunState::kCompleted, RunEvent::kStart, RunState::kRunning},
    {RunState::kAborted, RunEvent::kStart, RunState::kRunning},
    {RunState::kFailed, RunEvent::kStart, RunState::kRunning},
};

}  // namespace

std::optional<RunState> next_state(RunState state, RunEvent event) {
  for (const Transition& t : kTransitions) {
    if (t.from == state && t.event == event) return t.to;
  }
  return std::nullopt;
}

std::string_view name_of(RunState state) {
  constexpr std::array<std::string_view, 7> kNames{"idle",      "running", "paused", "stopping",
                                                   "completed", "aborted", "failed"};
  return kNames[static_cast<std::size_t>(state)];
}

}  // namespace fogbench::procedures
