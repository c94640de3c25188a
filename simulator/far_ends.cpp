#include "simulator/far_ends.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <memory>
#include <string>
#include <string_view>

#include "config/roles.hpp"

namespace fogbench::simulator {
namespace {

Status check_devices(const std::vector<config::FaultSpec>& faults,
                     const config::BenchConfig& bench) {
  std::vector<std::string_view> devices;
  config::for_each_role(
      [&](const char* role, const auto& its) {
        if (config::device_of(its) != nullptr) devices.emplace_back(role);
      },
      bench);
  for (const auto& sensor : bench.auxiliary) devices.push_back(sensor.name);
  for (std::size_t i = 0; i < faults.size(); ++i) {
    if (std::find(devices.begin(), devices.end(), faults[i].device) != devices.end()) continue;
    return Error{ErrorCode::kBadInput,
                 fmt::format("scenario: /faults/{}: no device \"{}\"; the bench has {}", i,
                             faults[i].device, fmt::join(devices, ", "))};
  }
  return {};
}

/// Makes the lines to the request-and-answer instruments.
class Lines {
 public:
  Lines(const config::ScenarioConfig& scenario, std::uint64_t seed, std::shared_ptr<Plant> plant,
        drivers::Clock& clock, drivers::Clock::Duration late_by)
      : scenario_(scenario),
        seed_(seed),
        plant_(std::move(plant)),
        clock_(clock),
        late_by_(late_by) {}

  Result<InstrumentLine> to(const std::string& device,
                            std::initializer_list<FaultKind> possible) const {
    Result<FaultSchedule> faults = FaultSchedule::create(scenario_.faults, device, possible);
    if (!faults) return faults.error();
    return InstrumentLine(plant_, clock_, *std::move(faults),
                          derive_seed(seed_, device + " garbage"), late_by_);
  }

 private:
  const config::ScenarioConfig& scenario_;
  std::uint64_t seed_;
  std::shared_ptr<Plant> plant_;
  drivers::Clock& clock_;
  drivers::Clock::Duration late_by_;
};

Result<AuxiliaryEnd> far_end_of(const config::AuxiliaryConfig& sensor, const Lines& lines,
                                std::uint64_t seed) {
  const auto make = [&]<class Device>(const Device& device) -> Result<AuxiliaryEnd> {
    if constexpr (std::is_same_v<Device, config::ModbusSensor>) {
      auto line = lines.to(sensor.name, ModbusFarEnd::kFaults);
      if (!line) return line.error();
      config::ModbusDevice map;
      map.unit_id = device.unit_id;
      for (const auto& channel : device.channels) map.registers.push_back(channel.place());
      return AuxiliaryEnd{sensor.name, std::make_unique<ModbusFarEnd>(map, *std::move(line))};
    } else if constexpr (std::is_same_v<Device, config::ScpiSensor>) {
      auto line = lines.to(sensor.name, ScpiFarEnd::kFaults);
      if (!line) return line.error();
      return AuxiliaryEnd{
          sensor.name, std::make_unique<ScpiFarEnd>(device.dialogue(), make_sensor_output(device),
                                                    *std::move(line))};
    } else if constexpr (std::is_same_v<Device, config::HidSensor>) {
      auto line = lines.to(sensor.name, HidFarEnd::kFaults);
      if (!line) return line.error();
      return AuxiliaryEnd{sensor.name, std::make_unique<HidFarEnd>(
                                           device.layout(), config::MagneticPlant{},
                                           *std::move(line), derive_seed(seed, sensor.name))};
    } else {
      auto line = lines.to(sensor.name, LineFarEnd::kFaults);
      if (!line) return line.error();
      return AuxiliaryEnd{sensor.name, std::make_unique<LineFarEnd>(device, *std::move(line))};
    }
  };
  return std::visit(make, sensor.device);
}

}  // namespace

void FarEnds::set_fault(std::string_view device, FaultKind kind, bool on) {
  bool found = false;
  const auto set = [&](std::string_view name, auto& end) {
    if (name != device) return;
    end->set_fault(kind, on);
    found = true;
  };
  config::for_each_role(set, *this);
  for (AuxiliaryEnd& sensor : auxiliary) {
    std::visit([&](auto& end) { set(sensor.name, end); }, sensor.end);
  }
  assert(found);
}

Result<FarEnds> make_far_ends(const config::BenchConfig& config,
                              const config::ScenarioConfig& scenario, std::uint64_t seed,
                              drivers::Clock& clock, drivers::Clock::Duration late_by) {
  if (Status s = check_devices(scenario.faults, config); !s) return s.error();
  Result<std::unique_ptr<Plant>> made = Plant::create(config, scenario, seed, clock);
  if (!made) return made.error();
  const std::shared_ptr<Plant> plant = *std::move(made);
  const Lines lines(scenario, seed, plant, clock, late_by);

  FarEnds ends;
  ends.plant = plant;
  {
    Result<InstrumentLine> line = lines.to("thermostat", ModbusFarEnd::kFaults);
    if (!line) return line.error();
    ends.thermostat = std::make_unique<ModbusFarEnd>(config.thermostat.device, *std::move(line));
  }
  const auto supply = [&](const std::string& name, const config::CoilConfig& coil,
                          MagneticPhysics::Pair pair) -> Result<std::unique_ptr<ScpiFarEnd>> {
    Result<InstrumentLine> line = lines.to(name, ScpiFarEnd::kSupplyFaults);
    if (!line) return line.error();
    return std::make_unique<ScpiFarEnd>(
        coil.device,
        make_supply_output(coil.device, pair, config.simulation.magnetic.supply_bits,
                           derive_seed(seed, name)),
        *std::move(line));
  };
  auto horizontal = supply("coil_horizontal", config.coil_horizontal, MagneticPhysics::kHorizontal);
  if (!horizontal) return horizontal.error();
  ends.coil_horizontal = *std::move(horizontal);
  auto vertical = supply("coil_vertical", config.coil_vertical, MagneticPhysics::kVertical);
  if (!vertical) return vertical.error();
  ends.coil_vertical = *std::move(vertical);
  if (config.turntable.motorised) {
    Result<InstrumentLine> line = lines.to("turntable", ScpiFarEnd::kFaults);
    if (!line) return line.error();
    ends.turntable = std::make_unique<ScpiFarEnd>(*config.turntable.device, make_turntable_output(),
                                                  *std::move(line));
  }
  if (config.magnetometer.fitted) {
    Result<InstrumentLine> line = lines.to("magnetometer", HidFarEnd::kFaults);
    if (!line) return line.error();
    ends.magnetometer =
        std::make_unique<HidFarEnd>(config.magnetometer.device, config.simulation.magnetic,
                                    *std::move(line), derive_seed(seed, "magnetometer"));
  }
  for (const config::AuxiliaryConfig& sensor : config.auxiliary) {
    auto end = far_end_of(sensor, lines, seed);
    if (!end) return end.error();
    ends.auxiliary.push_back(*std::move(end));
  }
  Result<FaultSchedule> faults =
      FaultSchedule::create(scenario.faults, "gyro", GyroFarEnd::kFaults);
  if (!faults) return faults.error();
  config::FrameDevice gyro = config.gyro.device;
  gyro.frame_rate_hz = config.simulation.gyro_frame_rate_hz.value_or(gyro.frame_rate_hz);
  ends.gyro = std::make_unique<GyroFarEnd>(gyro, scenario.noise, plant, *std::move(faults),
                                           derive_seed(seed, "gyro"));
  return ends;
}

}  // namespace fogbench::simulator
