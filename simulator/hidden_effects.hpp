#pragma once
// The sum of everything that the scenario makes the gyro do besides measuring: its published terms,
// what hides in it, and the state of its shield.

#include <string>
#include <vector>

#include "config/result.hpp"
#include "config/scenario.hpp"
#include "simulator/effects/effect.hpp"

namespace fogbench::simulator {

class HiddenEffects {
 public:
  /// kBadInput for an unknown effect or parameter (with the nearest known name), for a missing
  /// parameter, and for one outside its domain.
  static Result<HiddenEffects> create(const config::ScenarioConfig& scenario);

  /// An effect that acts on the channel of an auxiliary sensor, which the bench must have.
  struct OnChannel {
    std::string where, effect, channel;
  };
  const std::vector<OnChannel>& on_channels() const { return channels_; }

  /// The rate that the effects add in this step, deg/h. Call once a step.
  double advance(const TrueState& state);

 private:
  struct Term {
    double amplitude;
    bool magnetic;  ///< scaled by the shield's state
    Regressor regressor;
  };

  Status add(const config::HiddenEffect& hidden, const std::string& where);

  std::vector<Term> terms_;
  std::vector<OnChannel> channels_;
  std::vector<config::MagneticScaleChange> scale_changes_;  ///< by time
};

}  // namespace fogbench::simulator
