#pragma once
// The time that a run has left: the plan's estimates, where those of the steps that wait for
// evidence are scaled by how long such steps have really taken so far. Coming near a temperature
// and settling there are scaled apart: heaters and controller err in their own ways.

#include <algorithm>
#include <array>
#include <variant>
#include <vector>

#include "procedures/plan.hpp"

namespace fogbench::procedures {

class RemainingTime {
 public:
  /// The plan must outlive it.
  explicit RemainingTime(const Plan& plan) : plan_(plan), after_(plan.steps.size() + 1) {
    for (std::size_t i = plan.steps.size(); i-- > 0;) {
      after_[i] = after_[i + 1];
      after_[i][kind_of(i)] += plan.steps[i].estimate;
    }
  }

  void step_ended(std::size_t step, Seconds took) {
    const Kind kind = kind_of(step);
    if (kind == kFixed) return;
    estimated_[kind] += plan_.steps[step].estimate;
    took_[kind] += took;
  }

  /// `in_step`: how long the present step has lasted. Zero past the last step.
  Seconds remaining(std::size_t step, Seconds in_step) const {
    if (step >= plan_.steps.size()) return Seconds{0.0};
    const Seconds present = scale(kind_of(step)) * plan_.steps[step].estimate;
    Seconds left = std::max(Seconds{0.0}, present - in_step);
    for (const Kind kind : {kFixed, kApproach, kSettling}) {
      left += scale(kind) * after_[step + 1][kind];
    }
    return left;
  }

 private:
  enum Kind { kFixed, kApproach, kSettling };
  using Sums = std::array<Seconds, 3>;  ///< by kind

  Kind kind_of(std::size_t step) const {
    const auto* settle = std::get_if<SettleTemperature>(&plan_.steps[step].action);
    if (settle == nullptr) return kFixed;
    return settle->dwell.count() > 0.0 ? kSettling : kApproach;
  }
  double scale(Kind kind) const {
    return estimated_[kind].count() > 0.0 ? took_[kind] / estimated_[kind] : 1.0;
  }

  const Plan& plan_;
  std::vector<Sums> after_;  ///< estimates of the steps from each on
  Sums estimated_{}, took_{};
};

}  // namespace fogbench::procedures
