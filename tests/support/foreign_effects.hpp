#pragma once
// What can hide in the gyro of the foreign bench: every effect of the catalogue, written anew from
// its physics; the same physics in another shape (a loop that relaxes, a lag of two poles); and
// effects that the catalogue does not hold.

#include <random>
#include <string>
#include <vector>

#include "tests/support/foreign_world.hpp"

namespace fogbench::tests {

/// How an effect follows its physics: as the catalogue has it, or as another part would.
enum class Shape {
  kOwn,
  kOther,  ///< see other_shapes()
};

struct ForeignEffect {
  std::string id;          ///< a catalogue identifier or one of outside_effects()
  double amplitude = 1.0;  ///< deg/h per unit of the regressor
  double inner = 0.0;      ///< time, width, period, field: what the effect is not linear in
  double phase = 0.0;      ///< rad, of effects with a sine and a cosine
  Shape shape = Shape::kOwn;
};

/// Catalogue effects that have a second shape here:
///   magnetic_hysteresis_*    a magnetisation that relaxes towards a shifted curve (Duhem)
///   magnetic_saturation_*    x/sqrt(1 + x^2) instead of tanh x
///   magnetic_settling_*      two times, the longer four times the shorter
///   temperature_rate_lagged, coil_heating   two equal poles
///   warm_up                  two exponentials, the second four times as long and half as large
///   temperature_hysteresis   a loop that bends: plays of several widths
///   bias_step                takes 2 min
std::vector<std::string> other_shapes();

/// Effects that the catalogue does not hold.
std::vector<std::string> outside_effects();

/// What the effect adds to the rate, step by step, in units of its amplitude.
/// Precondition: a known id.
Series regressor(const World& world, const ForeignEffect& effect);

/// A value of the inner parameter, and a phase, as parts and benches have them.
ForeignEffect drawn_effect(const std::string& id, Shape shape, const World& world,
                           std::mt19937_64& engine);

}  // namespace fogbench::tests
