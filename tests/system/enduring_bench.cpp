#include "tests/system/enduring_bench.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>

namespace fogbench::system_test {
namespace {

using namespace std::chrono_literals;
using config::FaultKind;
using simulator::MagneticPhysics;
using Temper = EnduringBench::Temper;

/// Long enough for a watch to see that it is gone, shorter than anybody's patience.
constexpr drivers::Clock::Duration kExchange = 1500ms;
constexpr double kManual = 3.0;

class BorrowedMessages final : public drivers::MessageTransport {
 public:
  BorrowedMessages(drivers::MessageTransport& far_end, const Temper& temper)
      : far_end_(far_end), temper_(temper) {}
  Status write(std::string_view message) override {
    asked_identity_ = message == "*IDN?";
    if (temper_.disobeys && !message.ends_with('?')) return {};
    return far_end_.write(message);
  }
  Result<std::string> read(drivers::Clock::Duration timeout) override {
    auto answer = far_end_.read(timeout);
    if (answer && asked_identity_ && temper_.other_identity) return std::string("ANOTHER,1,2,3");
    return answer;
  }
  Status clear() override { return far_end_.clear(); }

 private:
  drivers::MessageTransport& far_end_;
  const Temper& temper_;
  bool asked_identity_ = false;
};

class BorrowedModbus final : public drivers::ModbusTransport {
 public:
  BorrowedModbus(drivers::ModbusTransport& far_end, Temper& temper, std::uint16_t mode_address)
      : far_end_(far_end), temper_(temper), mode_address_(mode_address) {}
  Status read_registers(std::uint16_t address, std::span<std::uint16_t> out) override {
    Status read = far_end_.read_registers(address, out);
    const std::size_t at = mode_address_ - std::size_t{address};
    if (read && temper_.manual && at < out.size()) out[at] = static_cast<std::uint16_t>(kManual);
    return read;
  }
  Status write_registers(std::uint16_t address, std::span<const std::uint16_t> values) override {
    if (temper_.disobeys) return {};
    Status written = far_end_.write_registers(address, values);
    if (written && address == mode_address_) temper_.manual = false;
    return written;
  }

 private:
  drivers::ModbusTransport& far_end_;
  Temper& temper_;
  const std::uint16_t mode_address_;
};

class BorrowedHid final : public drivers::HidTransport {
 public:
  explicit BorrowedHid(drivers::HidTransport& far_end) : far_end_(far_end) {}
  Result<std::size_t> read_report(std::span<std::uint8_t> out,
                                  drivers::Clock::Duration timeout) override {
    return far_end_.read_report(out, timeout);
  }
  Status write_report(std::span<const std::uint8_t> report) override {
    return far_end_.write_report(report);
  }

 private:
  drivers::HidTransport& far_end_;
};

class BorrowedSerial final : public drivers::SerialTransport {
 public:
  explicit BorrowedSerial(drivers::SerialTransport& far_end) : far_end_(far_end) {}
  Result<std::size_t> read_some(std::span<std::byte> out) override {
    return far_end_.read_some(out);
  }
  Status write(std::span<const std::byte> bytes) override { return far_end_.write(bytes); }

 private:
  drivers::SerialTransport& far_end_;
};

std::uint16_t address_of(const config::ModbusDevice& device, std::string_view name) {
  const auto found = std::find_if(device.registers.begin(), device.registers.end(),
                                  [&](const auto& spec) { return spec.name == name; });
  return found->address;
}

simulator::FarEnds far_ends(const config::BenchConfig& config, drivers::Clock& clock) {
  config::ScenarioConfig scenario;
  scenario.noise.angle_random_walk_deg_per_sqrt_h = 0.001;
  auto ends = simulator::make_far_ends(config, scenario, 1, clock);
  EXPECT_TRUE(ends) << ends.error().message;
  return *std::move(ends);
}

bool is_actuator(std::string_view device) {
  return device == "thermostat" || device.starts_with("coil_");
}

}  // namespace

void EventClock::sleep_until(Instant deadline) {
  while (!events_.empty() && events_.begin()->first <= deadline) {
    const auto [at, happens] = *events_.begin();
    events_.erase(events_.begin());
    clock_.sleep_until(at);
    happens();
  }
  clock_.sleep_until(deadline);
}

const std::vector<Fault>& all_faults() {
  static const std::vector<Fault> all = [] {
    constexpr Ill kAll[] = {Ill::kAbsent, Ill::kSilent, Ill::kStuck, Ill::kGarbling};
    const std::vector<std::pair<std::string_view, std::vector<Ill>>> more = {
        {"thermostat", {Ill::kBadChecksum, Ill::kNoNumber, Ill::kOpenCircuit, Ill::kManualMode}},
        {"coil_horizontal", {Ill::kWrongIdentity, Ill::kNoNumber, Ill::kOpenCircuit}},
        {"coil_vertical", {Ill::kWrongIdentity, Ill::kNoNumber, Ill::kOpenCircuit}},
        {"magnetometer", {Ill::kNoNumber}},
        {"turntable", {Ill::kWrongIdentity, Ill::kNoNumber}},
        {"gyro", {Ill::kBadChecksum, Ill::kNoNumber}}};
    std::vector<Fault> made;
    for (const auto& [device, ills] : more) {
      for (const Ill ill : kAll) made.push_back({device, ill});
      for (const Ill ill : ills) made.push_back({device, ill});
    }
    return made;
  }();
  return all;
}

std::string name_of(const Fault& fault) {
  constexpr const char* kNames[] = {"absent",       "silent",       "stuck",
                                    "garbling",     "bad checksum", "other one",
                                    "not a number", "open circuit", "in manual mode"};
  return fmt::format("{} {}", fault.device, kNames[static_cast<std::size_t>(fault.ill)]);
}

EnduringBench::EnduringBench(const config::BenchConfig& config)
    : config_(config), ends_(far_ends(config_, clock_)) {
  for (const auto& [name, end] : {std::pair{"coil_horizontal", ends_.coil_horizontal.get()},
                                  std::pair{"coil_vertical", ends_.coil_vertical.get()}}) {
    end->on_message([this, coil = std::string(name)](std::string_view message) {
      heard_.try_emplace({coil, std::string(message)}, clock_.now());
    });
  }
}

drivers::Transports EnduringBench::transports() {
  const auto messages = [this](std::string_view name, drivers::MessageTransport& end) {
    return std::make_unique<BorrowedMessages>(end, temper_[std::string(name)]);
  };
  return {
      .thermostat = std::make_unique<BorrowedModbus>(*ends_.thermostat, temper_["thermostat"],
                                                     address_of(config_.thermostat.device, "mode")),
      .coil_horizontal = messages("coil_horizontal", *ends_.coil_horizontal),
      .coil_vertical = messages("coil_vertical", *ends_.coil_vertical),
      .magnetometer = std::make_unique<BorrowedHid>(*ends_.magnetometer),
      .turntable = messages("turntable", *ends_.turntable),
      .gyro = std::make_unique<BorrowedSerial>(*ends_.gyro)};
}

void EnduringBench::energise() {
  ends_.plant->advance();
  for (const auto& [end, current] : {std::pair{ends_.coil_horizontal.get(), "CURR 3.000000"},
                                     std::pair{ends_.coil_vertical.get(), "CURR -2.000000"}}) {
    EXPECT_TRUE(end->write(current));
    EXPECT_TRUE(end->write(config_.coil_horizontal.device.output_on));
  }
  simulator::ThermostatController& controller = ends_.plant->thermostat();
  controller.set_target(config::Celsius{50.0});
  controller.set_mode(config::HeatingMode::kBoost);
  clock_.sleep_for(1s);
  EXPECT_NEAR(current_a("coil_horizontal"), 3.0, 1e-3);
  EXPECT_NEAR(current_a("coil_vertical"), -2.0, 1e-3);
  EXPECT_TRUE(heats());
}

void EnduringBench::begin(const Fault& fault, bool in_use) {
  const auto set = [&](FaultKind kind) { ends_.set_fault(fault.device, kind, true); };
  Temper& temper = temper_[std::string(fault.device)];
  switch (fault.ill) {
    case Ill::kAbsent:
      return set(FaultKind::kUnplug);
    case Ill::kSilent:
      return set(FaultKind::kTimeout);
    case Ill::kStuck:
      temper.disobeys = is_actuator(fault.device);
      return temper.disobeys ? void() : set(FaultKind::kStuck);
    case Ill::kGarbling:
      return set(FaultKind::kGarbage);
    case Ill::kBadChecksum:
      return set(FaultKind::kBadChecksum);
    case Ill::kNoNumber:
      return set(FaultKind::kNan);
    case Ill::kOpenCircuit:
      return set(FaultKind::kOpenCircuit);
    case Ill::kManualMode:
      temper.manual = true;
      return ends_.plant->thermostat().set_mode(config::HeatingMode::kBoost);
    case Ill::kWrongIdentity:
      temper.other_identity = true;
      if (!in_use) return;
      set(FaultKind::kUnplug);
      clock_.in(kExchange, [this, device = fault.device] {
        ends_.set_fault(device, FaultKind::kUnplug, false);
      });
  }
}

double EnduringBench::current_a(std::string_view coil) {
  ends_.plant->advance();
  return ends_.plant->magnetic().current_a(coil == "coil_horizontal" ? MagneticPhysics::kHorizontal
                                                                     : MagneticPhysics::kVertical);
}

bool EnduringBench::heats() {
  ends_.plant->advance();
  const simulator::ThermostatController& controller = ends_.plant->thermostat();
  return controller.mode() != config::HeatingMode::kOff || controller.power().total_w() > 0.0;
}

drivers::Clock::Instant EnduringBench::heard(std::string_view coil, std::string_view text) const {
  const auto found = heard_.find({std::string(coil), std::string(text)});
  return found == heard_.end() ? drivers::Clock::Instant::max() : found->second;
}

}  // namespace fogbench::system_test
