#pragma once
// Units at the seams between folders are types; inside numerics, SQL, JSON and CSV they are a
// suffix of the name. Each unit has one suffix, listed once, in kUnitSuffixes.

#include <chrono>
#include <cmath>
#include <compare>
#include <string_view>

namespace fogbench::config {

inline constexpr double kSecondsPerHour = 3600.0;

/// A number with a unit: quantities of one unit add and compare, nothing else converts.
template <class Unit>
struct Quantity {
  double value = 0.0;

  constexpr Quantity() = default;
  constexpr explicit Quantity(double v) : value(v) {}
  friend constexpr auto operator<=>(const Quantity&, const Quantity&) = default;
  friend constexpr Quantity operator+(Quantity a, Quantity b) {
    return Quantity{a.value + b.value};
  }
  friend constexpr Quantity operator-(Quantity a, Quantity b) {
    return Quantity{a.value - b.value};
  }
  friend constexpr Quantity operator-(Quantity a) { return Quantity{-a.value}; }
  friend constexpr Quantity operator*(double k, Quantity a) { return Quantity{k * a.value}; }
  friend constexpr Quantity operator/(Quantity a, double k) { return Quantity{a.value / k}; }
  friend constexpr double operator/(Quantity a, Quantity b) { return a.value / b.value; }
};

using Celsius = Quantity<struct CelsiusUnit>;
using CelsiusPerHour = Quantity<struct CelsiusPerHourUnit>;
using DegPerHour = Quantity<struct DegPerHourUnit>;
using Microtesla = Quantity<struct MicroteslaUnit>;
using Ampere = Quantity<struct AmpereUnit>;
using Watt = Quantity<struct WattUnit>;
using Degree = Quantity<struct DegreeUnit>;

/// How far apart two directions are, whichever turn they are written in: 0 to 180 deg.
inline Degree angle_between(Degree a, Degree b) {
  return Degree{std::abs(std::remainder(a.value - b.value, 360.0))};
}

/// A span of time as configuration and results speak of it, s.
using Seconds = std::chrono::duration<double>;

/// One suffix a unit: how a column or a key says its unit, and how it is printed.
struct UnitSuffix {
  std::string_view suffix;
  std::string_view unit;
};

inline constexpr UnitSuffix kUnitSuffixes[] = {
    // The first match wins: a suffix that ends with another stands before it.
    {"_deg_per_h_per_sqrt_h", "deg/h/sqrt(h)"},
    {"_deg_per_sqrt_h", "deg/sqrt(h)"},
    {"_deg_per_h", "deg/h"},
    {"_c_per_h2", "degC/h^2"},
    {"_c_per_h", "degC/h"},
    {"_per_h", "1/h"},
    {"_ut_per_a", "uT/A"},
    {"_c_per_w", "degC/W"},
    {"_w_per_k", "W/K"},
    {"_j_per_k", "J/K"},
    {"_deg", "deg"},
    {"_ut", "uT"},
    {"_hz", "Hz"},
    {"_c", "degC"},
    {"_a", "A"},
    {"_v", "V"},
    {"_w", "W"},
    {"_h", "h"},
    {"_s", "s"},
    {"_days", "days"},
    {"_percent", "%"},
    {"_hpa", "hPa"},
    {"_mv", "mV"},
    {"_ma", "mA"},
    {"_lx", "lx"},
};

/// The printed unit of a column or key name ("field_x_ut" -> "uT"); empty when it has none.
constexpr std::string_view unit_of(std::string_view name) {
  for (const UnitSuffix& entry : kUnitSuffixes) {
    if (name.ends_with(entry.suffix)) return entry.unit;
  }
  return {};
}

}  // namespace fogbench::config
