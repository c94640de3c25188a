#include "simulator/instrument_line.hpp"

#include <algorithm>

namespace fogbench::simulator {

Status InstrumentLine::request(drivers::Clock::Duration takes, drivers::Clock::Duration timeout) {
  if (fault(FaultKind::kUnplug)) return Error{ErrorCode::kUnplugged, "unplugged"};
  deadline_ = clock_.now() + timeout;
  if (fault(FaultKind::kTimeout)) return wait_in_vain();
  constexpr int kSlowFactor = 20;
  if (fault(FaultKind::kSlowAnswer)) takes = std::min(kSlowFactor * takes, timeout * 9 / 10);
  clock_.sleep_for(takes);
  plant_->advance();
  return {};
}

Status InstrumentLine::answer() {
  const bool late = fault(FaultKind::kLateAnswer);
  if (fault(FaultKind::kSilentExecution) || (late && late_by_ == drivers::Clock::Duration{})) {
    return wait_in_vain();
  }
  if (late) clock_.sleep_until(deadline_ + late_by_);
  if (fault(FaultKind::kBadChecksum)) {
    return Error{ErrorCode::kProtocol, "the answer's check value is wrong"};
  }
  if (fault(FaultKind::kBadSequence)) {
    return Error{ErrorCode::kProtocol, "the answer is to another request"};
  }
  return {};
}

Error InstrumentLine::wait_in_vain() {
  clock_.sleep_until(deadline_);
  plant_->advance();
  return Error{ErrorCode::kTimeout, "no answer"};
}

}  // namespace fogbench::simulator
