#pragma once
// What the simulated gyro hides and which instruments fail when (config/scenarios/*.json).
// Effect identifiers and their inner parameters are those of `fogbench effects`.

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "config/result.hpp"
#include "config/units.hpp"

namespace fogbench::config {

/// Noise coefficients in IEEE 952 vocabulary.
struct NoiseCoefficients {
  double angle_random_walk_deg_per_sqrt_h = 0.0;       ///< N
  double bias_instability_deg_per_h = 0.0;             ///< B
  double rate_random_walk_deg_per_h_per_sqrt_h = 0.0;  ///< K
  double quantisation_deg = 0.0;                       ///< Q

  friend bool operator==(const NoiseCoefficients&, const NoiseCoefficients&) = default;
};

/// A grade's coefficients by name: "tactical", "navigation", "none"; kBadInput otherwise.
Result<NoiseCoefficients> noise_grade(const std::string& name);

/// One effect acting on the true state: amplitude * regressor(inner parameters).
/// Effects with two columns (earth_rate_projection, temperature_ripple) take `phase_deg` too:
/// amplitude * cos(angle - phase).
struct HiddenEffect {
  std::string effect;
  double amplitude = 0.0;                    ///< deg/h per unit of the regressor
  std::map<std::string, double> parameters;  ///< width, tau, t0, period, hs, phase_deg
};

enum class FaultKind {
  kTimeout,
  kLateAnswer,
  kSilentExecution,
  kBadChecksum,
  kBadSequence,
  kGarbage,
  kNan,
  kStuck,
  kException,
  kUnplug,
  kSlowAnswer,
  kOpenCircuit
};

/// An instrument's misbehaviour: from `at` on, for `duration`; or in the operations `at_operation`
/// ... `at_operation + operations - 1` of that instrument, counted from 1, whenever they come.
/// An operation is one request with its answer, one report, one frame.
struct FaultSpec {
  std::string device;  ///< thermostat, coil_horizontal, ..., gyro, or an auxiliary sensor's name
  FaultKind kind = FaultKind::kTimeout;
  Seconds at{0.0};
  Seconds duration{0.0};
  std::optional<std::uint32_t> at_operation;
  std::uint32_t operations = 1;
  /// Only operations of this name (operations_of) are spoilt and counted; empty: all.
  std::string operation;
};

/// The names of an instrument's operations, in the order of its description; empty when there is no
/// such instrument.
std::vector<std::string_view> operations_of(std::string_view device);

/// A change of the shield's state between tests: all magnetic terms are multiplied by `factor`
/// from `at` on (the common scale of device 2 of the published table).
struct MagneticScaleChange {
  Seconds at{0.0};
  double factor = 1.0;
};

struct ScenarioConfig {
  std::string name;
  std::string description;
  NoiseCoefficients noise;              ///< JSON: a grade's name, or an object
  std::map<std::string, double> terms;  ///< "gyro": {"terms": {...}}: effect id -> coefficient
  std::vector<HiddenEffect> hidden;
  std::vector<MagneticScaleChange> magnetic_scale;
  std::vector<FaultSpec> faults;
  Celsius reference_temperature{21.0};
};

/// Errors: kBadInput, one line with the file and the JSON pointer.
Result<ScenarioConfig> load_scenario(const std::filesystem::path& file);

}  // namespace fogbench::config
