#include "drivers/reckoned_field.hpp"

#include <cmath>
#include <numbers>

namespace fogbench::drivers {

Result<FieldReading> ReckonedField::read() {
  const auto horizontal = horizontal_.read();
  if (!horizontal) return horizontal.error();
  const auto vertical = vertical_.read();
  if (!vertical) return vertical.error();
  const auto azimuth = turntable_.azimuth();
  if (!azimuth) return azimuth.error();
  const double up = ambient_ut_[0] + ut_per_a_[0] * horizontal->measured.value;
  const double north = ambient_ut_[1] + ut_per_a_[1] * vertical->measured.value;
  const double east = ambient_ut_[2];
  const double c = std::cos(azimuth->value * std::numbers::pi / 180.0);
  const double s = std::sin(azimuth->value * std::numbers::pi / 180.0);
  return FieldReading{
      clock_.now(),
      {Microtesla{up}, Microtesla{north * c + east * s}, Microtesla{north * s - east * c}}};
}

}  // namespace fogbench::drivers
