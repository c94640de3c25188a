#include "simulator/fault_schedule.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace fogbench::simulator {
namespace {

/// As scenario files spell them, in the enumeration's order.
constexpr const char* kNames[] = {
    "timeout", "late_answer", "silent_execution", "bad_checksum", "bad_sequence", "garbage",
    "nan",     "stuck",       "exception",        "unplug",       "slow_answer"};

const char* name_of(FaultKind kind) {
  return kNames[static_cast<std::size_t>(kind)];
}

}  // namespace

Result<FaultSchedule> FaultSchedule::create(const std::vector<config::FaultSpec>& faults,
                                            const std::string& device,
                                            std::initializer_list<FaultKind> possible) {
  FaultSchedule schedule;
  for (std::size_t i = 0; i < faults.size(); ++i) {
    if (faults[i].device != device) continue;
    if (std::find(possible.begin(), possible.end(), faults[i].kind) == possible.end()) {
      std::string known;
      for (const FaultKind kind : possible) known += fmt::format(" {}", name_of(kind));
      return Error{ErrorCode::kBadInput,
                   fmt::format("scenario: /faults/{}: {} cannot have the fault {}; it can:{}", i,
                               device, name_of(faults[i].kind), known)};
    }
    schedule.faults_.push_back(faults[i]);
  }
  return schedule;
}

bool FaultSchedule::active(FaultKind kind, double time_s) const {
  return std::any_of(faults_.begin(), faults_.end(), [&](const config::FaultSpec& fault) {
    return fault.kind == kind && time_s >= fault.at.count() &&
           time_s < (fault.at + fault.duration).count();
  });
}

}  // namespace fogbench::simulator
