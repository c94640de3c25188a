#pragma once
// How the run log and the exports spell enumerators.

#include <string_view>

#include "config/procedure.hpp"
#include "procedures/recorder.hpp"

namespace fogbench::daemon {

constexpr std::string_view name_of(procedures::PointKind kind) {
  switch (kind) {
    case procedures::PointKind::kBaseline:
      return "baseline";
    case procedures::PointKind::kAverage:
      return "average";
    case procedures::PointKind::kTransient:
      return "transient";
  }
  return "";
}

constexpr std::string_view name_of(procedures::RunOutcome outcome) {
  switch (outcome) {
    case procedures::RunOutcome::kCompleted:
      return "completed";
    case procedures::RunOutcome::kAborted:
      return "aborted";
    case procedures::RunOutcome::kFailed:
      return "failed";
    case procedures::RunOutcome::kInterrupted:
      return "interrupted";
  }
  return "";
}

constexpr std::string_view name_of(config::HeatingMode mode) {
  switch (mode) {
    case config::HeatingMode::kOff:
      return "off";
    case config::HeatingMode::kBoost:
      return "boost";
    case config::HeatingMode::kNormal:
      return "normal";
  }
  return "";
}

}  // namespace fogbench::daemon
