#include "simulator/magnetic_physics.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "config/units.hpp"

namespace fogbench::simulator {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr double kSecondsPerDay = 86400.0;

double wait_for_next(double mean_per_h, NormalSource& random) {
  if (mean_per_h <= 0.0) return std::numeric_limits<double>::infinity();
  return -std::log(random.uniform()) * config::kSecondsPerHour / mean_per_h;
}

}  // namespace

Vector3 to_gyro_axes(const Vector3& up_north_east, double azimuth_deg) {
  const auto [up, north, east] = up_north_east;
  const double c = std::cos(azimuth_deg * kRadPerDeg);
  const double s = std::sin(azimuth_deg * kRadPerDeg);
  return {up, north * c + east * s, north * s - east * c};
}

double quantise_current(double current_a, double full_scale_a, double bits) {
  const double lsb = full_scale_a / std::exp2(bits);
  return lsb * std::nearbyint(current_a / lsb);
}

MagneticPhysics::MagneticPhysics(const config::MagneticPlant& plant, double step_s,
                                 std::uint64_t seed)
    : plant_(plant),
      step_s_(step_s),
      disturbance_(seed),
      next_disturbance_s_(wait_for_next(plant.ambient_steps_per_h, disturbance_)) {
  for (std::size_t i = 0; i < 2; ++i) {
    const double tilt = plant.coil_misalignment_deg[i] * kRadPerDeg;
    const double along = plant.coil_ut_per_a[i] * std::cos(tilt);
    const double aside = plant.coil_ut_per_a[i] * std::sin(tilt);
    coil_[i].field_per_a_ut =
        i == kHorizontal ? Vector3{along, aside, 0.0} : Vector3{0.0, along, aside};
  }
}

void MagneticPhysics::program(Pair pair, double current_a, double time_constant_s) {
  coil_[pair].programmed_a = current_a;
  coil_[pair].follow = time_constant_s > 0.0 ? -std::expm1(-step_s_ / time_constant_s) : 1.0;
}

void MagneticPhysics::advance() {
  time_s_ += step_s_;
  for (Coil& coil : coil_) coil.current_a += coil.follow * (coil.programmed_a - coil.current_a);
  while (time_s_ >= next_disturbance_s_) {
    // The lift stops elsewhere: a disturbance of the same size in a new direction.
    Vector3 direction{disturbance_(), disturbance_(), disturbance_()};
    const double length = std::hypot(direction[0], direction[1], direction[2]);
    for (std::size_t i = 0; i < 3; ++i) {
      disturbance_ut_[i] = plant_.ambient_step.value * direction[i] / length;
    }
    next_disturbance_s_ += wait_for_next(plant_.ambient_steps_per_h, disturbance_);
  }
}

double MagneticPhysics::sum_squared_current_a2() const {
  double sum = 0.0;
  for (const Coil& coil : coil_) sum += coil.current_a * coil.current_a;
  return sum;
}

Vector3 MagneticPhysics::field_ut() const {
  const double daily =
      plant_.ambient_diurnal.value * std::sin(2.0 * std::numbers::pi * time_s_ / kSecondsPerDay);
  Vector3 field;
  for (std::size_t i = 0; i < 3; ++i) {
    field[i] = plant_.ambient_ut[i] + disturbance_ut_[i] +
               coil_[kHorizontal].current_a * coil_[kHorizontal].field_per_a_ut[i] +
               coil_[kVertical].current_a * coil_[kVertical].field_per_a_ut[i];
  }
  field[1] += daily;  // The horizontal component carries most of the daily change.
  return field;
}

}  // namespace fogbench::simulator
