#pragma once

#include <string>

#include "drivers/instruments.hpp"

namespace fogbench::daemon {

/// The person at the simulated bench: does what is asked at once.
class SimulatedOperator final : public drivers::Operator {
 public:
  Result<bool> confirm(const std::string&) override { return true; }
  std::string name() const override { return "the simulation"; }
};

}  // namespace fogbench::daemon
