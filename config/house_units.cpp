#include "config/house_units.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>

#include "config/stated_unit.hpp"

namespace fogbench::config {
namespace {

/// What the drivers take the quantities of these names for; nothing for a quantity that is only
/// shown, which may be anything.
std::optional<Dimension> dimension_of(std::string_view quantity) {
  constexpr std::pair<std::string_view, Dimension> kQuantities[] = {
      {"temperature_working_1", Dimension::kTemperature},
      {"temperature_working_2", Dimension::kTemperature},
      {"temperature_control", Dimension::kTemperature},
      {"temperature_ambient", Dimension::kTemperature},
      {"target", Dimension::kTemperature},
      {"working_target", Dimension::kTemperature},
      {"boost_power", Dimension::kPower},
      {"normal_power", Dimension::kPower},
      {"field_x", Dimension::kField},
      {"field_y", Dimension::kField},
      {"field_z", Dimension::kField}};
  for (const auto& [name, dimension] : kQuantities) {
    if (name == quantity) return dimension;
  }
  return std::nullopt;
}

bool is_count(std::string_view quantity) {
  return quantity == "mode" || quantity == "status" || quantity == "sequence";
}

/// The unit that is stated at `at`, or the house's. Null, and the error said, when it is none for
/// this kind of number; null without an error where a quantity that is only shown states none.
const StatedUnit* stated_unit(const Place& at, std::string_view stated,
                              std::optional<Dimension> dimension, bool& ok) {
  if (stated.empty()) return dimension ? find_unit(house_unit(*dimension)) : nullptr;
  const StatedUnit* const unit = find_unit(stated);
  if (unit != nullptr && (!dimension || unit->dimension == *dimension)) return unit;
  ok = (at / "unit").wrong(dimension ? known_units(*dimension) : known_units());
  return nullptr;
}

template <class Spec>
bool take_number(const Place& at, std::optional<Dimension> dimension, Spec& spec) {
  bool ok = true;
  const StatedUnit* const unit = stated_unit(at, spec.unit, dimension, ok);
  if (unit == nullptr) return ok;
  const auto taken = [unit](double stated) { return stated * unit->factor + unit->offset; };
  spec.unit = house_unit(unit->dimension);
  spec.scale *= unit->factor;
  spec.offset = taken(spec.offset);
  if constexpr (requires { spec.minimum; }) {
    if (spec.minimum) spec.minimum = taken(*spec.minimum);
    if (spec.maximum) spec.maximum = taken(*spec.maximum);
  }
  return ok;
}

/// A number that its name says the kind of.
template <class Spec>
bool take_named(const Place& at, Spec& spec) {
  if (!is_count(spec.name)) return take_number(at, dimension_of(spec.name), spec);
  return spec.unit.empty() || (at / "unit").wrong(fmt::format("none: {} is a count", spec.name));
}

template <class Spec>
bool take_all(const Place& at, std::vector<Spec>& specs) {
  bool ok = true;
  for (std::size_t i = 0; i < specs.size(); ++i) ok = take_named(at / i, specs[i]) && ok;
  return ok;
}

}  // namespace

bool take_to_house_units(const Place& at, ModbusDevice& device) {
  return take_all(at / "registers", device.registers);
}

bool take_to_house_units(const Place& at, ScpiDevice& device) {
  if (device.unit.empty()) return false;  // it was missed already
  const StatedUnit* const unit = find_unit(device.unit);
  if (unit == nullptr ||
      (unit->dimension != Dimension::kCurrent && unit->dimension != Dimension::kAngle)) {
    return (at / "unit")
        .wrong(fmt::format("{}, or {}", known_units(Dimension::kCurrent),
                           known_units(Dimension::kAngle)));
  }
  device.unit = house_unit(unit->dimension);
  for (double* number : {&device.scale, &device.minimum, &device.maximum, &device.resolution,
                         &device.read_back_tolerance}) {
    *number *= unit->factor;
  }
  return true;
}

bool take_to_house_units(const Place& at, HidDevice& device) {
  return take_all(at / "fields", device.fields);
}

bool take_to_house_units(const Place& at, FrameDevice& device) {
  bool ok = take_number(at / "rate", Dimension::kRate, device.rate);
  if (device.temperature) {
    ok = take_number(at / "temperature", Dimension::kTemperature, *device.temperature) && ok;
  }
  return take_all(at / "others", device.others) && ok;
}

}  // namespace fogbench::config
