#pragma once
// Operators with memory that several effects are made of.

#include <algorithm>
#include <cmath>

namespace fogbench::simulator {

/// First-order lag of time constant `tau`, exact for an input that is constant over a step.
class Lag {
 public:
  Lag(double tau_s, double initial) : tau_s_(tau_s), value_(initial) {}
  double follow(double input, double step_s) {
    value_ -= std::expm1(-step_s / tau_s_) * (input - value_);
    return value_;
  }

 private:
  double tau_s_;
  double value_;
};

/// Play (backlash) of half-width `width`: follows its input at that distance, from the state that
/// has no history.
class Play {
 public:
  explicit Play(double width) : width_(width) {}
  double follow(double input) {
    value_ = std::clamp(value_, input - width_, input + width_);
    return value_;
  }

 private:
  double width_;
  double value_ = 0.0;
};

}  // namespace fogbench::simulator
