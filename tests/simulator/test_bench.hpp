#pragma once
// A bench and instruments written out by hand, so that the simulator's tests need no files.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "config/bench.hpp"
#include "config/scenario.hpp"
#include "drivers/clock.hpp"
#include "simulator/plant.hpp"
#include "simulator/simulated_bench.hpp"

namespace fogbench::simulator {

inline config::ModbusDevice test_thermostat() {
  using config::Access;
  using config::NumberType;
  config::ModbusDevice device;
  device.name = "test controller";
  const auto add = [&](std::string name, std::uint16_t address, NumberType type, double scale,
                       Access access = Access::kRead) {
    config::RegisterSpec spec;
    spec.name = std::move(name);
    spec.address = address;
    spec.type = type;
    spec.scale = scale;
    spec.access = access;
    device.registers.push_back(spec);
  };
  add("temperature_working_1", 0x100, NumberType::kFloat32, 1.0);
  add("temperature_working_2", 0x102, NumberType::kFloat32, 1.0);
  add("temperature_control", 0x104, NumberType::kInt32, 0.001);
  add("temperature_ambient", 0x106, NumberType::kInt16, 0.01);
  add("target", 2, NumberType::kInt16, 0.1, Access::kReadWrite);
  device.registers.back().minimum = 0.0;
  device.registers.back().maximum = 70.0;
  add("working_target", 5, NumberType::kInt16, 0.1);
  add("mode", 273, NumberType::kUint16, 1.0, Access::kReadWrite);
  add("boost_power", 85, NumberType::kInt16, 0.01);
  add("normal_power", 86, NumberType::kInt16, 0.01);
  add("setup", 300, NumberType::kUint16, 1.0, Access::kReadWrite);
  device.modes = {{"off", 0.0}, {"boost", 1.0}, {"normal", 2.0}};
  return device;
}

inline config::ScpiDevice test_supply() {
  config::ScpiDevice device;
  device.identity = "KEPCO,BOP 36-6";
  device.initialise = {"*CLS", "FUNC:MODE CURR", "VOLT 30"};
  device.set = "CURR {value}";
  device.set_query = "CURR?";
  device.measure_query = "MEAS:CURR?";
  device.output_on = "OUTP ON";
  device.output_off = "OUTP OFF";
  device.minimum = -4.0;
  device.maximum = 4.0;
  return device;
}

inline config::ScpiDevice test_turntable() {
  config::ScpiDevice device;
  device.identity = "TURNTABLE";
  device.set = "POS {value}";
  device.set_query = "POS?";
  device.measure_query = "MEAS:POS?";
  device.minimum = -360.0;
  device.maximum = 360.0;
  return device;
}

inline config::HidDevice test_magnetometer() {
  using config::NumberType;
  config::HidDevice device;
  device.report_id = 7;
  device.report_bytes = 16;
  device.range = config::Microtesla{600.0};
  const char* const names[] = {"field_x", "field_y", "field_z"};
  for (std::uint16_t i = 0; i < 3; ++i) {
    config::FieldSpec field;
    field.name = names[i];
    field.offset_bytes = static_cast<std::uint16_t>(1 + 4 * i);
    field.scale = 1e-4;
    device.fields.push_back(field);
  }
  config::FieldSpec sequence;
  sequence.name = "sequence";
  sequence.offset_bytes = 13;
  sequence.type = NumberType::kUint8;
  device.fields.push_back(sequence);
  return device;
}

/// The layout of KVH 1750 and DSP-1760.
inline config::FrameDevice test_gyro(double frame_rate_hz) {
  using config::NumberType;
  config::FrameDevice device;
  device.header = {0xFE, 0x81, 0xFF, 0x55};
  device.frame_bytes = 36;
  device.rate.name = "rate_x";
  device.rate.offset_bytes = 4;
  device.rate.type = NumberType::kFloat32;
  device.rate.scale = 3600.0;
  config::FieldSpec temperature;
  temperature.name = "temperature";
  temperature.offset_bytes = 30;
  temperature.type = NumberType::kInt16;
  device.temperature = temperature;
  config::FieldSpec acceleration;
  acceleration.name = "acceleration_x";
  acceleration.offset_bytes = 16;
  acceleration.type = NumberType::kFloat32;
  device.others = {acceleration};
  device.status_offset_bytes = 28;
  device.status_valid_mask = 0x01;
  device.sequence_offset_bytes = 29;
  device.sequence_modulus = 128;
  device.crc.polynomial = 0x04C11DB7;
  device.crc.initial = 0xFFFFFFFF;
  device.crc.count_bytes = 32;
  device.crc.offset_bytes = 32;
  device.frame_rate_hz = frame_rate_hz;
  return device;
}

inline config::BenchConfig test_bench(double frame_rate_hz = 100.0) {
  config::BenchConfig bench;
  bench.thermostat.device = test_thermostat();
  bench.coil_horizontal.device = test_supply();
  bench.coil_vertical.device = test_supply();
  bench.magnetometer.device = test_magnetometer();
  bench.turntable.motorised = true;
  bench.turntable.device = test_turntable();
  bench.gyro.device = test_gyro(frame_rate_hz);
  return bench;
}

/// A plant of its own on a virtual clock.
struct TestPlant {
  explicit TestPlant(const config::BenchConfig& bench = test_bench(),
                     const config::ScenarioConfig& scenario = {}, std::uint64_t seed = 1)
      : owner(*Plant::create(bench, scenario, seed, clock)), plant(*owner) {}

  void run_for(double seconds) {
    clock.sleep_for(drivers::from_seconds(seconds));
    plant.advance();
  }

  drivers::VirtualClock clock;
  std::unique_ptr<Plant> owner;
  Plant& plant;
};

/// Far ends on a virtual clock.
struct TestFarEnds {
  explicit TestFarEnds(const config::BenchConfig& bench = test_bench(),
                       const config::ScenarioConfig& scenario = {}, std::uint64_t seed = 1)
      : ends(*simulate_bench(bench, scenario, seed, clock)) {}

  void run_for(double seconds) { clock.sleep_for(drivers::from_seconds(seconds)); }

  drivers::VirtualClock clock;
  drivers::Transports ends;
};

inline config::FaultSpec fault(std::string device, config::FaultKind kind, double at_s,
                               double duration_s) {
  return {std::move(device), kind, config::Seconds{at_s}, config::Seconds{duration_s}};
}

}  // namespace fogbench::simulator
