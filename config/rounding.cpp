#include "config/rounding.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace fogbench::config {
namespace {

// Beyond these a row of zeros says less than a power of ten.
constexpr int kMostDecimals = 9;
constexpr int kMostZeros = 4;

/// Exponent of the first digit, once the value is rounded to `digits` digits.
int exponent_of(double value, int digits) {
  const std::string text = fmt::format("{:.{}e}", value, digits - 1);
  return std::atoi(text.c_str() + text.find('e') + 1);
}

/// Rounded to the digit that counts 10^place.
std::string to_place(double value, int place) {
  if (place < -kMostDecimals || place > kMostZeros) {
    const int first = value == 0.0 ? place : exponent_of(value, 6);
    return fmt::format("{:.{}e}", value, std::max(0, first - place));
  }
  const double step = std::pow(10.0, std::max(place, 0));
  const std::string fixed = fmt::format(
      "{:.{}f}", place > 0 ? std::round(value / step) * step : value, std::max(-place, 0));
  // No minus in front of nothing but zeros.
  const bool zero = fixed.find_first_of("123456789") == std::string::npos;
  return zero && fixed.front() == '-' ? fixed.substr(1) : fixed;
}

}  // namespace

Rounded rounded(double value, double uncertainty) {
  if (!std::isfinite(value) || !std::isfinite(uncertainty) || uncertainty <= 0.0) {
    return {std::isnan(value) ? "-" : fmt::format("{:.6g}", value),
            std::isnan(uncertainty) ? "-" : fmt::format("{:.2g}", uncertainty)};
  }
  const int place = exponent_of(uncertainty, 2) - 1;
  return {to_place(value, place), to_place(uncertainty, place)};
}

std::string significant(double value, int digits) {
  if (!std::isfinite(value)) return "-";
  const int place = exponent_of(value, digits) - digits + 1;
  return place > 0 && place <= kMostZeros ? to_place(value, place)
                                          : fmt::format("{:.{}g}", value, digits);
}

}  // namespace fogbench::config
