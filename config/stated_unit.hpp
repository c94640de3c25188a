#pragma once
// The units that a device file may state for a number, and the one of each kind that this program
// reckons in: the house's. house value = stated value * factor + offset.

#include <string>
#include <string_view>

namespace fogbench::config {

/// What a number of an instrument is.
enum class Dimension {
  kRate,          ///< house unit deg/h
  kTemperature,   ///< degC
  kField,         ///< uT
  kCurrent,       ///< A
  kPower,         ///< W
  kAngle,         ///< deg
  kAcceleration,  ///< g
  kVoltage,       ///< V
  kTime,          ///< s
  kFrequency,     ///< Hz
  kShare          ///< %
};

struct StatedUnit {
  std::string_view name;
  Dimension dimension;
  double factor = 1.0;
  double offset = 0.0;
};

/// The unit of that name, spelt exactly so; null for none.
const StatedUnit* find_unit(std::string_view name);
/// The name of the unit that the house reckons in.
std::string_view house_unit(Dimension dimension);
/// "a rotation rate in deg/h, deg/s, ...": what an error line expects.
std::string known_units(Dimension dimension);
/// All of them, the house's first of each kind.
std::string known_units();

}  // namespace fogbench::config
