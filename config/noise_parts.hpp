#pragma once
// The noise coefficients of IEEE 952 as they are named on screens and in JSON documents.

#include <array>
#include <nlohmann/json.hpp>

#include "config/scenario.hpp"

namespace fogbench::config {

struct NoisePart {
  const char* name;
  const char* key;  ///< in JSON
  const char* unit;
  double NoiseCoefficients::*value;
};

inline constexpr std::array<NoisePart, 4> kNoiseParts = {{
    {"angle random walk N", "N_deg_per_sqrt_h", "deg/sqrt(h)",
     &NoiseCoefficients::angle_random_walk_deg_per_sqrt_h},
    {"bias instability B", "B_deg_per_h", "deg/h", &NoiseCoefficients::bias_instability_deg_per_h},
    {"rate random walk K", "K_deg_per_h_per_sqrt_h", "deg/h/sqrt(h)",
     &NoiseCoefficients::rate_random_walk_deg_per_h_per_sqrt_h},
    {"quantisation Q", "Q_deg", "deg", &NoiseCoefficients::quantisation_deg},
}};

/// N, B and K: what a fit can say of a gyro's noise.
inline nlohmann::ordered_json noise_json(const NoiseCoefficients& noise) {
  nlohmann::ordered_json out;
  for (std::size_t i = 0; i < 3; ++i) out[kNoiseParts[i].key] = noise.*kNoiseParts[i].value;
  return out;
}

}  // namespace fogbench::config
