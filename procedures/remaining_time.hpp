#pragma once
// The time that a run has left: the plan's estimates, where those of the steps that wait for
// evidence (settling) are scaled by how long such steps have really taken so far.

#include <algorithm>
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
      (settles(i) ? after_[i].settling : after_[i].fixed) += plan.steps[i].estimate;
    }
  }

  void step_ended(std::size_t step, Seconds took) {
    if (!settles(step)) return;
    estimated_ += plan_.steps[step].estimate;
    took_ += took;
  }

  /// `in_step`: how long the present step has lasted. Zero past the last step.
  Seconds remaining(std::size_t step, Seconds in_step) const {
    if (step >= plan_.steps.size()) return Seconds{0.0};
    const double scale = estimated_.count() > 0.0 ? took_ / estimated_ : 1.0;
    const Seconds present = (settles(step) ? scale : 1.0) * plan_.steps[step].estimate;
    return std::max(Seconds{0.0}, present - in_step) + after_[step + 1].fixed +
           scale * after_[step + 1].settling;
  }

 private:
  struct Sums {
    Seconds fixed{0.0}, settling{0.0};
  };
  bool settles(std::size_t step) const {
    return std::holds_alternative<SettleTemperature>(plan_.steps[step].action);
  }

  const Plan& plan_;
  std::vector<Sums> after_;             ///< of the steps from each on
  Seconds estimated_{0.0}, took_{0.0};  ///< of the settling steps so far
};

}  // namespace fogbench::procedures
