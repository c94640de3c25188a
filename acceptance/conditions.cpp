#include "acceptance/conditions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "model/effects/catalogue.hpp"
#include "model/table/moving_signals.hpp"

namespace fogbench::acceptance {
using model::Conditions;
using procedures::Point;

namespace {

constexpr std::string_view kAxes = "xyz";
constexpr std::array kFields = {&Point::field_x_ut, &Point::field_y_ut, &Point::field_z_ut};
constexpr std::array<std::string_view, 7> kOwnQuantities = {"K_x",
                                                            "K_y",
                                                            "K_z",
                                                            "temperature_sigma",
                                                            "angle_random_walk",
                                                            "bias_instability",
                                                            "rate_random_walk"};
/// Temperatures closer than this are one set point.
constexpr double kOneTemperature_c = 1.0;

const model::Effect* effect_of(std::string_view quantity) {
  return model::find_effect(quantity.substr(0, quantity.find('.')));
}

/// The axes of whose field the quantity speaks: "", "x", "xy".
std::string axes_of(std::string_view quantity) {
  if (quantity.starts_with("K_")) return std::string(quantity.substr(2));
  const model::Effect* const effect = effect_of(quantity);
  std::string axes;
  if (effect == nullptr) return axes;
  for (const char axis : kAxes) {
    const std::string field = fmt::format("field_{}_ut", axis);
    const auto& signals = effect->info().signals;
    if (std::find(signals.begin(), signals.end(), field) != signals.end()) axes += axis;
  }
  return axes;
}

void widen(double value, double& low, double& high) {
  if (!std::isfinite(value)) return;
  low = std::isnan(low) ? value : std::min(low, value);
  high = std::isnan(high) ? value : std::max(high, value);
}

std::string range(double low, double high, double one) {
  if (high - low < one) return fmt::format("{:.0f}", std::round(0.5 * (low + high)) + 0.0);
  return fmt::format("{:.0f}..{:.0f}", std::round(low) + 0.0, std::round(high) + 0.0);
}

}  // namespace

Conditions conditions_at_rest(std::span<const Point> points) {
  Conditions out;
  for (const Point& point : points) {
    widen(point.temperature_c, out.temperature_low_c, out.temperature_high_c);
  }
  return out;
}

Conditions conditions_of(std::string_view quantity, std::span<const Point> points) {
  Conditions out{.axes = axes_of(quantity)};
  const double least = model::least_excitation("field_x_ut");
  std::vector<Point> chosen;
  for (const Point& point : points) {
    // Outside a sweep the field is the room's.
    const bool swept = std::isfinite(point.field_set_ut);
    bool energised = false;
    for (const char axis : out.axes) {
      const double field = point.*kFields[kAxes.find(axis)];
      energised = energised || (swept && std::abs(field) > least);
    }
    if (out.axes.empty() ? !swept : energised) chosen.push_back(point);
  }
  const Conditions at = conditions_at_rest(chosen.empty() ? points : chosen);
  out.temperature_low_c = at.temperature_low_c;
  out.temperature_high_c = at.temperature_high_c;
  for (const Point& point : chosen) {
    for (const char axis : out.axes) {
      widen(point.*kFields[kAxes.find(axis)], out.field_low_ut, out.field_high_ut);
    }
  }
  return out;
}

std::string conditions_text(const Conditions& conditions, std::string_view celsius,
                            std::string_view microtesla) {
  if (std::isnan(conditions.temperature_low_c)) return "";
  std::string text = fmt::format(
      "{} {}",
      range(conditions.temperature_low_c, conditions.temperature_high_c, kOneTemperature_c),
      celsius);
  if (std::isnan(conditions.field_low_ut)) return fmt::format("{}, 0 {}", text, microtesla);
  std::string axes;
  for (const char axis : conditions.axes) axes += static_cast<char>(axis - 'x' + 'X');
  return fmt::format("{}, O{} {} {}", text, axes,
                     range(conditions.field_low_ut, conditions.field_high_ut, 1.0), microtesla);
}

bool is_quantity(std::string_view name) {
  return effect_of(name) != nullptr ||
         std::find(kOwnQuantities.begin(), kOwnQuantities.end(), name) != kOwnQuantities.end();
}

}  // namespace fogbench::acceptance
