#include "simulator/modbus_far_end.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>

#include "drivers/number_codec.hpp"
#include "simulator/modbus_exception.hpp"

namespace fogbench::simulator {

using config::Access;
using config::HeatingMode;
using config::NumberType;
using config::RegisterSpec;

namespace {

using namespace std::chrono_literals;

/// A short frame each way at 9600 baud, and the instrument's turn-around.
constexpr drivers::Clock::Duration kTransaction = 20ms;
constexpr drivers::Clock::Duration kTimeout = 500ms;

std::optional<HeatingMode> mode_named(const std::string& name) {
  if (name == "off") return HeatingMode::kOff;
  if (name == "boost") return HeatingMode::kBoost;
  if (name == "normal") return HeatingMode::kNormal;
  return std::nullopt;
}

/// What a register shows when the instrument has no number: NaN, or the type's most negative.
void encode_no_number(const RegisterSpec& spec, std::span<std::uint16_t> words) {
  std::fill(words.begin(), words.end(), std::uint16_t{0});
  const bool low_first = words.size() == 2 && spec.word_order == config::WordOrder::kLowFirst;
  words[low_first ? 1 : 0] = spec.type == NumberType::kFloat32 ? 0x7FC0 : 0x8000;
}

}  // namespace

ModbusFarEnd::ModbusFarEnd(const config::ModbusDevice& device, InstrumentLine line)
    : device_(device), line_(std::move(line)) {
  for (const RegisterSpec& spec : device_.registers) by_address_[spec.address] = &spec;
}

Error ModbusFarEnd::exception(int code) {
  last_exception_ = code;
  constexpr const char* kMeaning[] = {"", "illegal function", "illegal data address",
                                      "illegal data value", "device failure"};
  return Error{ErrorCode::kDevice, fmt::format("Modbus exception {} ({})", code, kMeaning[code])};
}

Status ModbusFarEnd::check_count(std::size_t count) {
  if (line_.fault(FaultKind::kException)) return exception(kDeviceFailure);
  constexpr std::size_t kMost = 125;  // Of the standard's function 3.
  if (count == 0 || count > kMost) return exception(kIllegalValue);
  if (device_.even_counts_only && count % 2 != 0) return exception(kIllegalValue);
  return {};
}

std::string_view ModbusFarEnd::write_operation(std::uint16_t address) const {
  const auto found = by_address_.find(address);
  if (found == by_address_.end()) return "";
  const std::string& name = found->second->name;
  return name == "target" ? "set_target" : name == "mode" ? "set_mode" : "";
}

Status ModbusFarEnd::read_registers(std::uint16_t address, std::span<std::uint16_t> out) {
  line_.begin("read");
  last_exception_ = 0;
  if (Status s = line_.request(kTransaction, kTimeout); !s) return s;
  line_.plant().open_heaters(line_.fault(FaultKind::kOpenCircuit));
  if (Status s = check_count(out.size()); !s) return s;
  for (std::size_t i = 0; i < out.size();) {
    const auto found = by_address_.find(static_cast<std::uint16_t>(address + i));
    if (found == by_address_.end()) return exception(kIllegalAddress);
    const RegisterSpec& spec = *found->second;
    const std::size_t words = drivers::word_count(spec.type);
    if (spec.access == Access::kWrite || i + words > out.size()) return exception(kIllegalAddress);
    encode(spec, out.subspan(i, words));
    i += words;
  }
  return line_.answer();
}

Status ModbusFarEnd::write_registers(std::uint16_t address, std::span<const std::uint16_t> values) {
  line_.begin(write_operation(address));
  last_exception_ = 0;
  if (Status s = line_.request(kTransaction, kTimeout); !s) return s;
  if (Status s = check_count(values.size()); !s) return s;
  for (std::size_t i = 0; i < values.size();) {
    const auto found = by_address_.find(static_cast<std::uint16_t>(address + i));
    if (found == by_address_.end()) return exception(kIllegalAddress);
    const RegisterSpec& spec = *found->second;
    const std::size_t words = drivers::word_count(spec.type);
    if (spec.access == Access::kRead || i + words > values.size()) {
      return exception(kIllegalAddress);
    }
    const Result<double> value = drivers::read_words(spec, values.subspan(i, words));
    if (!value) return exception(kIllegalValue);
    if (Status s = apply(spec, *value); !s) return s;
    i += words;
  }
  return line_.answer();
}

Status ModbusFarEnd::apply(const RegisterSpec& spec, double value) {
  if ((spec.minimum && value < *spec.minimum) || (spec.maximum && value > *spec.maximum)) {
    return exception(kIllegalValue);
  }
  ThermostatController& controller = line_.plant().thermostat();
  if (spec.name == "target") {
    controller.set_target(config::Celsius{value});
  } else if (spec.name == "mode") {
    const auto found = std::find_if(device_.modes.begin(), device_.modes.end(),
                                    [&](const auto& mode) { return mode.second == value; });
    const std::optional<HeatingMode> mode =
        found == device_.modes.end() ? std::nullopt : mode_named(found->first);
    if (!mode) return exception(kIllegalValue);
    controller.set_mode(*mode);
  }
  memory_[spec.name] = value;
  return {};
}

double ModbusFarEnd::value_of(const RegisterSpec& spec) {
  Plant& plant = line_.plant();
  if (const auto measured = plant.auxiliary(spec.name)) return *measured;
  const ThermostatController& controller = plant.thermostat();
  if (spec.name == "temperature_working_1") return controller.sensors_c()[0];
  if (spec.name == "temperature_working_2") return controller.sensors_c()[1];
  if (spec.name == "temperature_control") return controller.sensors_c()[2];
  if (spec.name == "temperature_ambient") return controller.ambient_c();
  if (spec.name == "target" || spec.name == "working_target") return controller.target().value;
  if (spec.name == "boost_power") return controller.power().boost_w;
  if (spec.name == "normal_power") return controller.power().normal_w;
  if (spec.name == "mode") {
    for (const auto& [name, value] : device_.modes) {
      if (mode_named(name) == controller.mode()) return value;
    }
  }
  const auto stored = memory_.find(spec.name);
  return stored == memory_.end() ? 0.0 : stored->second;
}

void ModbusFarEnd::encode(const RegisterSpec& spec, std::span<std::uint16_t> words) {
  if (line_.fault(FaultKind::kGarbage)) {
    for (std::uint16_t& word : words) word = static_cast<std::uint16_t>(line_.random()());
    return;
  }
  const bool measured =
      spec.name.starts_with("temperature_") || line_.plant().has_auxiliary(spec.name);
  if (measured && line_.fault(FaultKind::kNan)) return encode_no_number(spec, words);
  const bool stuck = measured && line_.fault(FaultKind::kStuck) && memory_.contains(spec.name);
  const double value = stuck ? memory_[spec.name] : value_of(spec);
  memory_[spec.name] = value;
  if (!drivers::write_words(spec, value, words)) encode_no_number(spec, words);
}

}  // namespace fogbench::simulator
