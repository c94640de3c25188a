#pragma once
// The field of a bench without a magnetometer.

#include <array>
#include <string>

#include "config/bench.hpp"
#include "drivers/instruments.hpp"

namespace fogbench::drivers {

/// What the coils' measured currents make, by their nominal field per ampere, on top of the ambient
/// field that the bench's file states:
///
///   up = ambient_up + k_h I_h,  north = ambient_north + k_v I_v,  east = ambient_east
///
/// in the gyro's axes at its azimuth. Nobody has measured it: iron nearby, misaligned coils and a
/// lift that passes are not in it.
class ReckonedField final : public Magnetometer {
 public:
  /// The instruments must outlive it.
  ReckonedField(const config::BenchConfig& config, CoilSupply& horizontal, CoilSupply& vertical,
                Turntable& turntable, Clock& clock)
      : ambient_ut_(config.magnetometer.ambient_ut),
        ut_per_a_{config.coil_horizontal.field_ut_per_a, config.coil_vertical.field_ut_per_a},
        horizontal_(horizontal),
        vertical_(vertical),
        turntable_(turntable),
        clock_(clock) {}

  Result<std::string> identity() override {
    return std::string("none: the field is reckoned from the coils' currents");
  }
  /// Errors: the supplies' and the turntable's.
  Result<FieldReading> read() override;

 private:
  std::array<double, 3> ambient_ut_;
  std::array<double, 2> ut_per_a_;
  CoilSupply& horizontal_;
  CoilSupply& vertical_;
  Turntable& turntable_;
  Clock& clock_;
};

}  // namespace fogbench::drivers
