#pragma once
// Measurement tables from a simulator of its own, for trying the diagnosis: neither the bench
// simulator nor the catalogue's code is used, so that a wrong equation cannot confirm itself.
// Everything happens on a 10 s grid of true states and is averaged over the windows afterwards.

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "model/table.hpp"

namespace fogbench::tests {

enum class Design {
  kMagnetic,        ///< three axes, 0 -> 300 -> -300 -> 0 uT, 180 s windows: 75 rows
  kThermal,         ///< warm-up and six plateaus, 60 s windows throughout, heating only
  kThermalCooling,  ///< the same with a cooling branch
  kMixed            ///< a magnetic part at two temperatures after a thermal one
};

struct ForeignNoise {
  double white = 0.001;    ///< deg/sqrt(h)
  double flicker = 0.003;  ///< deg/h
  double walk = 0.003;     ///< deg/h/sqrt(h)
};
inline constexpr ForeignNoise kNavigation{0.001, 0.003, 0.003};
inline constexpr ForeignNoise kTactical{0.005, 0.02, 0.02};

struct ForeignEffect {
  std::string id;          ///< a catalogue identifier or one of outside_effects()
  double amplitude = 0.0;  ///< deg/h per unit of the regressor
  double inner = 0.0;
  double phase = 0.0;      ///< rad, for two-column effects
};

/// Shapes that no catalogue effect has.
std::vector<std::string> outside_effects();

struct ForeignTable {
  model::Table table;
  /// The hidden effects' sum in every row and the noise in every row, deg/h.
  std::vector<double> hidden, noise;
};

/// The base (bias, and the linear terms that a first model has) is added unasked:
/// magnetic 0.7 + (-0.05, 0.12, -0.25) h; thermal 0.7 - 0.01 t.
ForeignTable make_foreign_table(Design design, const ForeignNoise& noise,
                                const std::vector<ForeignEffect>& hidden, std::uint64_t seed);

/// Terms of the base model for the design.
std::vector<std::string> base_terms(Design design);

}  // namespace fogbench::tests
