#include "drivers/modbus_thermostat.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "drivers/named_error.hpp"
#include "drivers/number_codec.hpp"

namespace fogbench::drivers {
namespace {

using config::RegisterSpec;

constexpr std::size_t kMostWords = 125;  ///< of one Modbus read

/// A controller refreshes its registers once per cycle, some tenths of a second later at most.
constexpr int kPowerLooks = 10;
constexpr Clock::Duration kPowerLook = std::chrono::milliseconds{100};
/// Below what any heater is switched at, above the resolution of a power reading.
constexpr double kOffW = 0.1;
constexpr const char* kOffKey = "off";

constexpr std::pair<HeatingMode, const char*> kModes[] = {
    {HeatingMode::kOff, kOffKey}, {HeatingMode::kBoost, "boost"}, {HeatingMode::kNormal, "normal"}};

bool is_within(const RegisterSpec& spec, double value) {
  return !(spec.minimum && value < *spec.minimum) && !(spec.maximum && value > *spec.maximum);
}

std::string range_text(const RegisterSpec& spec) {
  const auto bound = [](const std::optional<double>& b, const char* none) {
    return b ? fmt::format("{}", *b) : std::string(none);
  };
  return fmt::format("{} ... {} {}", bound(spec.minimum, "any"), bound(spec.maximum, "any"),
                     spec.unit);
}

}  // namespace

const std::array<const char*, ModbusThermostat::kQuantities> ModbusThermostat::kNames = {
    "temperature_working_1",
    "temperature_working_2",
    "temperature_control",
    "temperature_ambient",
    "target",
    "mode",
    "boost_power",
    "normal_power"};

ModbusThermostat::ModbusThermostat(std::string name, config::ModbusDevice device,
                                   std::unique_ptr<ModbusTransport> transport, Clock& clock)
    : name_(std::move(name)),
      device_(std::move(device)),
      transport_(std::move(transport)),
      clock_(clock),
      stillness_(device_.stuck_after) {}

Result<std::unique_ptr<ModbusThermostat>> ModbusThermostat::attach(
    std::string name, const config::ModbusDevice& device,
    std::unique_ptr<ModbusTransport> transport, Clock& clock) {
  std::unique_ptr<ModbusThermostat> thermostat(
      new ModbusThermostat(std::move(name), device, std::move(transport), clock));
  if (const Status map = thermostat->check_map(); !map) return map.error();
  thermostat->group_registers();
  return thermostat;
}

Status ModbusThermostat::begin() {
  const auto first = read();
  return first ? Status{} : first.error();
}

Error ModbusThermostat::error(ErrorCode code, const std::string& message) const {
  return {code, name_ + ": " + message};
}

Status ModbusThermostat::check_map() {
  for (std::size_t i = 0; i < kQuantities; ++i) {
    const auto found =
        std::find_if(device_.registers.begin(), device_.registers.end(),
                     [&](const RegisterSpec& spec) { return spec.name == kNames[i]; });
    if (found == device_.registers.end()) {
      return error(ErrorCode::kBadInput,
                   fmt::format("the map {} has no register {}", device_.name, kNames[i]));
    }
    if (device_.even_counts_only && word_count(found->type) % 2 != 0) {
      return error(ErrorCode::kBadInput,
                   fmt::format("register {} is one word of {}, but {} takes even counts only",
                               found->name, name_of(found->type), device_.name));
    }
    specs_[i] = &*found;
  }
  for (const auto& [mode, key] : kModes) {
    if (!device_.modes.contains(key)) {
      return error(ErrorCode::kBadInput,
                   fmt::format("the map {} has no value for mode {}", device_.name, key));
    }
  }
  return {};
}

void ModbusThermostat::group_registers() {
  auto sorted = specs_;
  std::sort(sorted.begin(), sorted.end(),
            [](const auto* a, const auto* b) { return a->address < b->address; });
  for (const RegisterSpec* spec : sorted) {
    const std::size_t count = word_count(spec->type);
    if (!groups_.empty()) {
      Group& last = groups_.back();
      const std::size_t offset = spec->address - std::size_t{last.address};
      if (offset <= last.words.size() && offset + count <= kMostWords) {
        last.words.resize(std::max(last.words.size(), offset + count));
        continue;
      }
    }
    groups_.push_back({spec->address, std::vector<std::uint16_t>(count)});
  }
}

Status ModbusThermostat::read_words(std::uint16_t address, std::span<std::uint16_t> words,
                                    const Patience& patience) {
  return ask_again(patience, [&] { return transport_->read_registers(address, words); });
}

Result<double> ModbusThermostat::read_one(const RegisterSpec& spec, const Patience& patience) {
  std::vector<std::uint16_t> words(word_count(spec.type));
  if (const Status status = read_words(spec.address, words, patience); !status) {
    return error(status.error().code, fmt::format("reading register {} at {}: {}", spec.name,
                                                  spec.address, status.error().message));
  }
  return value_of(spec, words);
}

Result<double> ModbusThermostat::value_of(const RegisterSpec& spec,
                                          std::span<const std::uint16_t> words) const {
  const auto value = drivers::read_words(spec, words);
  if (!value) return named(name_, value.error());
  if (is_within(spec, *value)) return *value;
  return error(ErrorCode::kProtocol,
               fmt::format("register {} at {} reads {} {}, expected {}", spec.name, spec.address,
                           *value, spec.unit, range_text(spec)));
}

Status ModbusThermostat::write_and_verify(const RegisterSpec& spec, double value) {
  std::vector<std::uint16_t> words(word_count(spec.type));
  if (const Status encoded = write_words(spec, value, words); !encoded) {
    return named(name_, encoded.error());
  }
  const double wanted = *drivers::read_words(spec, words);  // rounded as the register rounds
  if (!is_within(spec, wanted)) {
    return error(ErrorCode::kLimit,
                 fmt::format("{} {} for register {} at {}, expected {}", wanted, spec.unit,
                             spec.name, spec.address, range_text(spec)));
  }
  Patience patience(clock_, Patience::kForCommand);
  const auto failed = [&](ErrorCode code, const std::string& why) {
    return error(code, fmt::format("writing {} {} to register {} at {}: {}", wanted, spec.unit,
                                   spec.name, spec.address, why));
  };
  for (;;) {
    const Status written = transport_->write_registers(spec.address, words);
    const bool is_refused = !written && written.error().code != ErrorCode::kBusy &&
                            !Patience::may_be_lost(written.error());
    if (is_refused) return failed(written.error().code, written.error().message);
    const auto back = read_one(spec, patience);
    if (!back) return back.error();
    if (std::abs(*back - wanted) <= 1e-6 * std::max(1.0, std::abs(wanted))) return {};
    if (written) {
      return error(ErrorCode::kDevice,
                   fmt::format("register {} at {} was set to {} {} but reads back {} {}", spec.name,
                               spec.address, wanted, spec.unit, *back, spec.unit));
    }
    if (patience.again(written.error())) continue;
    const Error given_up = patience.given_up(written.error());
    // It has just answered, so nobody needs to wait for its return.
    const bool is_there = given_up.code == ErrorCode::kUnplugged;
    return failed(is_there ? ErrorCode::kDevice : given_up.code, given_up.message);
  }
}

Status ModbusThermostat::set_target(Celsius target) {
  const RegisterSpec& spec = *specs_[kTarget];
  const double lowest =
      std::max(device_.target_minimum.value, spec.minimum.value_or(device_.target_minimum.value));
  const double highest =
      std::min(device_.target_maximum.value, spec.maximum.value_or(device_.target_maximum.value));
  if (!(target.value >= lowest && target.value <= highest)) {
    return error(ErrorCode::kLimit, fmt::format("target {} degC is outside {} ... {} degC",
                                                target.value, lowest, highest));
  }
  return write_and_verify(spec, target.value);
}

Status ModbusThermostat::set_mode(HeatingMode mode) {
  for (const auto& [known, key] : kModes) {
    if (known == mode) return write_and_verify(*specs_[kMode], device_.modes.at(key));
  }
  return error(ErrorCode::kLimit, "no such heating mode");
}

Status ModbusThermostat::switch_off() {
  const RegisterSpec& spec = *specs_[kMode];
  std::vector<std::uint16_t> words(word_count(spec.type));
  if (const Status encoded = write_words(spec, device_.modes.at(kOffKey), words); !encoded) {
    return named(name_, encoded.error());
  }
  const Status written = ask_while_busy(Patience(clock_, Patience::kForReading), [&] {
    return transport_->write_registers(spec.address, words);
  });
  return written ? written
                 : error(written.error().code,
                         fmt::format("switching the heaters off: {}", written.error().message));
}

Status ModbusThermostat::confirm_off() {
  const double off = device_.modes.at(kOffKey);
  const auto mode = read_one(*specs_[kMode], Patience(clock_, Patience::kForReading));
  if (!mode) return mode.error();
  if (*mode != off) {
    return error(ErrorCode::kDevice,
                 fmt::format("the heating mode reads back {}, expected {} (off)", *mode, off));
  }
  double power_w = 0.0;
  for (int look = 0; look < kPowerLooks; ++look) {
    if (look > 0) clock_.sleep_for(kPowerLook);
    power_w = 0.0;
    for (const Quantity heater : {kBoostPower, kNormalPower}) {
      const auto power = read_one(*specs_[heater], Patience(clock_, Patience::kForReading));
      if (power) power_w += *power;
    }
    if (power_w <= kOffW) return {};
  }
  return error(ErrorCode::kDevice, fmt::format("the heaters still draw {:.1f} W", power_w));
}

Result<HeatingMode> ModbusThermostat::mode_of(double value) const {
  std::string expected;
  for (const auto& [mode, key] : kModes) {
    const double known = device_.modes.at(key);
    if (value == known) return mode;
    expected += fmt::format("{}{} ({})", expected.empty() ? "" : ", ", known, key);
  }
  return error(ErrorCode::kProtocol, fmt::format("register mode at {} reads {}, expected {}",
                                                 specs_[kMode]->address, value, expected));
}

Result<ThermostatReading> ModbusThermostat::read() {
  const Clock::Instant started = clock_.now();
  const Patience patience(clock_, Patience::kForReading);
  for (Group& group : groups_) {
    if (const Status status = read_words(group.address, group.words, patience); !status) {
      return error(status.error().code,
                   fmt::format("reading registers {} ... {}: {}", group.address,
                               group.address + group.words.size() - 1, status.error().message));
    }
  }
  std::array<double, kQuantities> values{};
  for (std::size_t i = 0; i < kQuantities; ++i) {
    const RegisterSpec& spec = *specs_[i];
    const auto group = std::find_if(groups_.begin(), groups_.end(), [&](const Group& g) {
      return spec.address >= g.address && spec.address < g.address + g.words.size();
    });
    const auto value = value_of(
        spec,
        std::span(group->words).subspan(spec.address - group->address, word_count(spec.type)));
    if (!value) return value.error();
    values[i] = *value;
  }
  const auto mode = mode_of(values[kMode]);
  if (!mode) return mode.error();
  const Clock::Instant now = clock_.now();
  if (now - started > device_.max_age) {
    return error(ErrorCode::kStale,
                 fmt::format("the reading took {:.1f} s, it may be {} s old",
                             to_seconds(now - started), device_.max_age.count()));
  }
  const auto still = stillness_.add(std::span(values).first(kAmbient + 1), now);
  if (still) {
    return error(ErrorCode::kStale,
                 fmt::format("no temperature has moved by a bit for {:.1f} s", still->count()));
  }
  return ThermostatReading{.taken_at = now,
                           .working_1 = Celsius{values[kWorking1]},
                           .working_2 = Celsius{values[kWorking2]},
                           .control = Celsius{values[kControl]},
                           .ambient = Celsius{values[kAmbient]},
                           .target = Celsius{values[kTarget]},
                           .mode = *mode,
                           .boost_power = Watt{values[kBoostPower]},
                           .normal_power = Watt{values[kNormalPower]}};
}

}  // namespace fogbench::drivers
