#pragma once
// What can hide in the simulated gyro. Each effect is a regressor of the true state; the scenario
// gives its amplitude. The equations are written here on purpose without a look at the analysis:
// the two share the identifiers only, so that a wrong equation cannot confirm itself.

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "simulator/magnetic_physics.hpp"

namespace fogbench::simulator {

/// What is true at the end of a step of the plant, as no instrument sees it.
struct TrueState {
  double step_s = 0.0;
  double time_s = 0.0;                   ///< since power-on
  double temperature_c = 0.0;            ///< of the carrier
  double reference_temperature_c = 0.0;  ///< the scenario's
  double temperature_rate_c_per_h = 0.0;
  double temperature_acceleration_c_per_h2 = 0.0;
  double temperature_gradient_c = 0.0;
  double heater_w = 0.0;
  double ambient_c = 0.0;
  Vector3 field_100ut{};  ///< gyro axes, in units of 100 uT
  double sum_squared_current_a2 = 0.0;
  double azimuth_deg = 0.0;
  std::map<std::string, double, std::less<>> auxiliary;  ///< less their means, in their units

  double above_reference_c() const { return temperature_c - reference_temperature_c; }
  /// By an auxiliary sensor, less its mean; 0 for a channel that the bench does not have.
  double measured(std::string_view channel) const {
    const auto found = auxiliary.find(channel);
    return found == auxiliary.end() ? 0.0 : found->second;
  }
};

/// Called once a step, in order; may remember.
using Regressor = std::function<double(const TrueState&)>;

/// What an inner parameter's value must obey.
enum class ParameterDomain { kAny, kNotNegative, kPositive };

struct EffectParameter {
  std::string name;
  ParameterDomain domain = ParameterDomain::kPositive;
  bool required = true;  ///< else 0 when absent
};

/// What a scenario says of an effect beside its amplitude.
struct Given {
  std::vector<double> inner;  ///< in the order of the effect's parameters
  std::string channel;        ///< of "effect(channel)"; else empty
};

/// All that anybody asks of an effect. One effect, or one family of the three axes, is one file in
/// simulator/effects/catalogue/; the build makes the list of these files.
struct EffectEntry {
  std::string id;
  std::vector<EffectParameter> parameters = {};
  std::function<Regressor(const Given&)> make;
  /// Through the shield: it scales with the shield's state (a scenario's magnetic_scale).
  bool through_shield = false;
  /// It acts on the channel of an auxiliary sensor that is named with it: "sensitivity(supply_v)".
  bool of_a_channel = false;
  /// It acts on the channel of an auxiliary sensor, always on this one.
  std::string channel = {};
};

/// All effects that the simulator can hide, in the order of their files.
const std::vector<EffectEntry>& all_effects();

/// An effect by the name that a scenario gives it.
struct NamedEffect {
  const EffectEntry* entry = nullptr;
  std::string channel;  ///< of an auxiliary sensor that it acts on; empty: none
};
/// "bias", "sensitivity(supply_v)"; nothing when there is none of that name.
std::optional<NamedEffect> find_effect(std::string_view name);

}  // namespace fogbench::simulator
