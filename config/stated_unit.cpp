#include "config/stated_unit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "config/units.hpp"

namespace fogbench::config {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;
constexpr double kZeroCelsiusInKelvin = 273.15;
/// T m/A, CODATA 2018: a field strength is taken for the flux density that it has in vacuum.
constexpr double kVacuumPermeability = 1.25663706212e-6;
constexpr double kStandardGravity = 9.80665;  ///< m/s^2, exact by definition (CGPM 1901)

/// The house's unit stands first of its kind.
constexpr StatedUnit kUnits[] = {
    {"deg/h", Dimension::kRate},
    {"deg/min", Dimension::kRate, 60.0},
    {"deg/s", Dimension::kRate, kSecondsPerHour},
    {"mdeg/s", Dimension::kRate, 1e-3 * kSecondsPerHour},
    {"rad/s", Dimension::kRate, kDegPerRad* kSecondsPerHour},
    {"mrad/s", Dimension::kRate, 1e-3 * kDegPerRad* kSecondsPerHour},
    {"urad/s", Dimension::kRate, 1e-6 * kDegPerRad* kSecondsPerHour},
    {"arcsec/s", Dimension::kRate, kSecondsPerHour / 3600.0},
    {"arcsec/h", Dimension::kRate, 1.0 / 3600.0},
    {"rev/s", Dimension::kRate, 360.0 * kSecondsPerHour},
    {"rpm", Dimension::kRate, 360.0 * 60.0},

    {"degC", Dimension::kTemperature},
    {"mdegC", Dimension::kTemperature, 1e-3},
    {"K", Dimension::kTemperature, 1.0, -kZeroCelsiusInKelvin},
    {"mK", Dimension::kTemperature, 1e-3, -kZeroCelsiusInKelvin},
    {"degF", Dimension::kTemperature, 5.0 / 9.0, -160.0 / 9.0},

    {"uT", Dimension::kField},
    {"nT", Dimension::kField, 1e-3},
    {"mT", Dimension::kField, 1e3},
    {"T", Dimension::kField, 1e6},
    {"G", Dimension::kField, 100.0},
    {"mG", Dimension::kField, 0.1},
    {"A/m", Dimension::kField, 1e6 * kVacuumPermeability},
    {"kA/m", Dimension::kField, 1e9 * kVacuumPermeability},

    {"A", Dimension::kCurrent},
    {"mA", Dimension::kCurrent, 1e-3},
    {"uA", Dimension::kCurrent, 1e-6},

    {"W", Dimension::kPower},
    {"mW", Dimension::kPower, 1e-3},
    {"kW", Dimension::kPower, 1e3},

    {"deg", Dimension::kAngle},
    {"mdeg", Dimension::kAngle, 1e-3},
    {"rad", Dimension::kAngle, kDegPerRad},
    {"mrad", Dimension::kAngle, 1e-3 * kDegPerRad},
    {"arcmin", Dimension::kAngle, 1.0 / 60.0},
    {"arcsec", Dimension::kAngle, 1.0 / 3600.0},

    {"g", Dimension::kAcceleration},
    {"mg", Dimension::kAcceleration, 1e-3},
    {"m/s^2", Dimension::kAcceleration, 1.0 / kStandardGravity},

    {"V", Dimension::kVoltage},
    {"mV", Dimension::kVoltage, 1e-3},

    {"s", Dimension::kTime},
    {"ms", Dimension::kTime, 1e-3},
    {"us", Dimension::kTime, 1e-6},
    {"ns", Dimension::kTime, 1e-9},
    {"min", Dimension::kTime, 60.0},
    {"h", Dimension::kTime, kSecondsPerHour},
    {"d", Dimension::kTime, 24.0 * kSecondsPerHour},

    {"Hz", Dimension::kFrequency},
    {"kHz", Dimension::kFrequency, 1e3},

    {"%", Dimension::kShare},
};

std::string_view kind_of_number(Dimension dimension) {
  switch (dimension) {
    case Dimension::kRate:
      return "a rotation rate";
    case Dimension::kTemperature:
      return "a temperature";
    case Dimension::kField:
      return "a magnetic field";
    case Dimension::kCurrent:
      return "a current";
    case Dimension::kPower:
      return "a power";
    case Dimension::kAngle:
      return "an angle";
    case Dimension::kAcceleration:
      return "an acceleration";
    case Dimension::kVoltage:
      return "a voltage";
    case Dimension::kTime:
      return "a time";
    case Dimension::kFrequency:
      return "a frequency";
    case Dimension::kShare:
      return "a share";
  }
  return "";
}

template <class Wanted>
std::string names_of(Wanted wanted) {
  std::string names;
  for (const StatedUnit& unit : kUnits) {
    if (wanted(unit)) names += fmt::format("{}{}", names.empty() ? "" : ", ", unit.name);
  }
  return names;
}

}  // namespace

const StatedUnit* find_unit(std::string_view name) {
  const auto* const found = std::find_if(std::begin(kUnits), std::end(kUnits),
                                         [&](const StatedUnit& unit) { return unit.name == name; });
  return found == std::end(kUnits) ? nullptr : found;
}

std::string_view house_unit(Dimension dimension) {
  return std::find_if(std::begin(kUnits), std::end(kUnits),
                      [&](const StatedUnit& unit) { return unit.dimension == dimension; })
      ->name;
}

std::string known_units(Dimension dimension) {
  return fmt::format("{} in {}", kind_of_number(dimension),
                     names_of([&](const StatedUnit& unit) { return unit.dimension == dimension; }));
}

std::string known_units() {
  return "one of " + names_of([](const StatedUnit&) { return true; });
}

}  // namespace fogbench::config
