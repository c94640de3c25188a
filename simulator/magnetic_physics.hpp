#pragma once
// The field at the gyro: the Earth's with its daily change, disturbances by lifts and cars, and two
// pairs of Helmholtz coils driven by current supplies.
//
// Bench frame: up, north, east. The horizontal pair of rings makes the field along the vertical,
// its axis tilted towards north; the vertical pair's axis points north, tilted towards east (the
// non-orthogonality). Gyro axes (right-handed, azimuth A clockwise seen from above):
//
//   x = up,   y = north cos A + east sin A,   z = north sin A - east cos A
//
// so that Y points north at azimuth 0 and Z at 90 deg.

#include <array>

#include "config/bench.hpp"
#include "simulator/random.hpp"

namespace fogbench::simulator {

using Vector3 = std::array<double, 3>;

/// Bench frame to gyro axes.
Vector3 to_gyro_axes(const Vector3& up_north_east, double azimuth_deg);

/// Output current of a bipolar supply: `bits` and a sign over the full scale.
double quantise_current(double current_a, double full_scale_a, double bits);

class MagneticPhysics {
 public:
  enum Pair { kHorizontal = 0, kVertical = 1 };

  MagneticPhysics(const config::MagneticPlant& plant, double step_s, std::uint64_t seed);

  void advance();
  /// The supply's output is programmed; the current follows with the time constant.
  void program(Pair pair, double current_a, double time_constant_s);

  double current_a(Pair pair) const { return coil_[pair].current_a; }
  double sum_squared_current_a2() const;
  /// Up, north, east.
  Vector3 field_ut() const;

 private:
  struct Coil {
    double programmed_a = 0.0;
    double current_a = 0.0;
    double follow = 1.0;  ///< part of the way that the current goes in a step
    Vector3 field_per_a_ut{};
  };

  const config::MagneticPlant plant_;
  const double step_s_;
  NormalSource disturbance_;
  double time_s_ = 0.0;
  double next_disturbance_s_;
  Vector3 disturbance_ut_{};
  std::array<Coil, 2> coil_;
};

}  // namespace fogbench::simulator
