#include "simulator/fault_schedule.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace fogbench::simulator {
namespace {

/// As scenario files spell them, in the enumeration's order.
constexpr const char* kNames[] = {
    "timeout", "late_answer", "silent_execution", "bad_checksum", "bad_sequence", "garbage",
    "nan",     "stuck",       "exception",        "unplug",       "slow_answer",  "open_circuit"};

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
    schedule.faults_.push_back({faults[i]});
    // Before its first operation an instrument is in none.
    schedule.faults_.back().applies = faults[i].operation.empty();
  }
  return schedule;
}

void FaultSchedule::begin(std::string_view operation) {
  for (Fault& fault : faults_) {
    fault.applies = fault.spec.operation.empty() || fault.spec.operation == operation;
    if (fault.applies) ++fault.seen;
  }
}

void FaultSchedule::set(FaultKind kind, bool on) {
  if (on) {
    by_hand_.insert(kind);
  } else {
    by_hand_.erase(kind);
  }
}

bool FaultSchedule::active(FaultKind kind, double time_s) const {
  if (by_hand_.contains(kind)) return true;
  return std::any_of(faults_.begin(), faults_.end(), [&](const Fault& fault) {
    const config::FaultSpec& spec = fault.spec;
    if (spec.kind != kind || !fault.applies) return false;
    if (spec.at_operation) {
      return fault.seen >= *spec.at_operation && fault.seen - *spec.at_operation < spec.operations;
    }
    return time_s >= spec.at.count() && time_s < (spec.at + spec.duration).count();
  });
}

bool FaultSchedule::unplugged(double time_s) const {
  if (by_hand_.contains(FaultKind::kUnplug)) return true;
  return std::any_of(faults_.begin(), faults_.end(), [&](const Fault& fault) {
    const config::FaultSpec& spec = fault.spec;
    return spec.kind == FaultKind::kUnplug && !spec.at_operation && spec.operation.empty() &&
           time_s >= spec.at.count() && time_s < (spec.at + spec.duration).count();
  });
}

}  // namespace fogbench::simulator
