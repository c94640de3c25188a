#pragma once
// What can hide in the simulated gyro. Each effect is a regressor of the true state; the scenario
// gives its amplitude. The equations are written here on purpose without a look at the analysis:
// the two share the identifiers only, so that a wrong equation cannot confirm itself.

#include <functional>
#include <map>
#include <optional>
#include <span>
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

struct EffectEntry {
  std::string id;
  std::vector<EffectParameter> parameters;
  /// `inner` in the order of `parameters`.
  std::function<Regressor(std::span<const double> inner)> make;
  /// Through the shield: it scales with the shield's state (a scenario's magnetic_scale).
  bool through_shield = false;
};

// One function per family, each in a file of its own.
void add_drift_effects(std::vector<EffectEntry>& entries);
void add_temperature_effects(std::vector<EffectEntry>& entries);
void add_magnetic_effects(std::vector<EffectEntry>& entries);
void add_bench_effects(std::vector<EffectEntry>& entries);

/// The channel of "sensitivity(pressure_hpa)"; nothing for another effect's name.
std::optional<std::string> sensitive_to(std::string_view id);
/// The rate follows a quantity that an auxiliary sensor of the bench measures, less its mean; the
/// amplitude is in deg/h per unit of the channel.
Regressor sensitivity_to(std::string channel);

/// All effects that the simulator can hide.
const std::vector<EffectEntry>& all_effects();

}  // namespace fogbench::simulator
