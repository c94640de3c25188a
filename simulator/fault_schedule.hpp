#pragma once
// When one instrument misbehaves, and how: at a time, in the n-th of its operations, or by hand.

#include <cstdint>
#include <initializer_list>
#include <set>
#include <string>
#include <string_view>
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

  /// The instrument's next operation begins: one of config::operations_of(device).
  void begin(std::string_view operation);
  /// In the present operation, at that time since power-on.
  bool active(FaultKind kind, double time_s) const;
  /// Whether the plug is out at that time, not only for one operation.
  bool unplugged(double time_s) const;
  /// A fault by hand: of every operation from now on, until it is switched off.
  void set(FaultKind kind, bool on);
  bool empty() const { return faults_.empty() && by_hand_.empty(); }

 private:
  struct Fault {
    config::FaultSpec spec;
    std::uint32_t seen = 0;  ///< operations of its name, the present one included
    bool applies = true;     ///< to the present operation, by its name
  };
  std::vector<Fault> faults_;
  std::set<FaultKind> by_hand_;
};

}  // namespace fogbench::simulator
