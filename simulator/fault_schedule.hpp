#pragma once
// When one instrument misbehaves, and how.

#include <initializer_list>
#include <string>
#include <vector>

#include "config/result.hpp"
#include "config/scenario.hpp"

namespace fogbench::simulator {

using config::FaultKind;

class FaultSchedule {
 public:
  FaultSchedule() = default;
  /// The faults of `device`. kBadInput when it cannot have one of them.
  static Result<FaultSchedule> create(const std::vector<config::FaultSpec>& faults,
                                      const std::string& device,
                                      std::initializer_list<FaultKind> possible);

  bool active(FaultKind kind, double time_s) const;
  bool empty() const { return faults_.empty(); }

 private:
  std::vector<config::FaultSpec> faults_;
};

}  // namespace fogbench::simulator
