// A controller whose registers hold anything and whose line fails in any way.

#include <cmath>

#include "drivers/modbus_thermostat.hpp"
#include "tests/fuzz/fuzz_input.hpp"

namespace fogbench::fuzz {
namespace {

using config::NumberType;

class AnyRegisters final : public drivers::ModbusTransport {
 public:
  explicit AnyRegisters(Input& input) : input_(input) {}
  Status read_registers(std::uint16_t, std::span<std::uint16_t> out) override {
    require(++requests_ < 20000);
    if (Status line = next(); !line) return line;
    for (std::uint16_t& word : out) word = input_.number<std::uint16_t>();
    return {};
  }
  Status write_registers(std::uint16_t, std::span<const std::uint16_t> values) override {
    require(++requests_ < 20000);
    // The target, in tenths, within 0 ... 70 degC; or a mode.
    for (const std::uint16_t word : values) require(word <= 700);
    return next();
  }

 private:
  Status next() {
    if (input_.empty()) return Error{ErrorCode::kDevice, "gone"};
    constexpr ErrorCode kFailures[] = {ErrorCode::kTimeout, ErrorCode::kProtocol,
                                       ErrorCode::kDevice, ErrorCode::kBusy};
    const std::uint8_t choice = input_.byte();
    if (choice < std::size(kFailures)) return Error{kFailures[choice], "the line fails"};
    return {};
  }
  Input& input_;
  int requests_ = 0;
};

config::ModbusDevice map(bool low_first) {
  config::ModbusDevice device;
  device.name = "any";
  const auto add = [&](const char* name, std::uint16_t address, NumberType type, double scale) {
    config::RegisterSpec spec;
    spec.name = name;
    spec.address = address;
    spec.type = type;
    spec.scale = scale;
    spec.minimum = 0.0;
    spec.maximum = 120.0;
    if (low_first) spec.word_order = config::WordOrder::kLowFirst;
    device.registers.push_back(spec);
  };
  add("temperature_working_1", 100, NumberType::kFloat32, 1.0);
  add("temperature_working_2", 102, NumberType::kInt32, 0.001);
  add("temperature_control", 104, NumberType::kUint32, 0.001);
  add("temperature_ambient", 106, NumberType::kInt16, 0.1);
  add("target", 2, NumberType::kInt16, 0.1);
  add("mode", 3, NumberType::kUint16, 1.0);
  add("boost_power", 10, NumberType::kInt16, 0.01);
  add("normal_power", 11, NumberType::kUint16, 0.01);
  device.modes = {{"off", 0}, {"boost", 1}, {"normal", 2}};
  device.target_maximum = config::Celsius{70.0};
  device.stuck_after = config::Seconds{5.0};
  return device;
}

}  // namespace
}  // namespace fogbench::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fogbench;  // NOLINT(google-build-using-namespace)
  fuzz::Input input(data, size);
  const config::ModbusDevice device = fuzz::map(input.byte() % 2 == 1);
  drivers::VirtualClock clock;
  auto thermostat = drivers::begun(drivers::ModbusThermostat::attach(
      "thermostat", device, std::make_unique<fuzz::AnyRegisters>(input), clock));
  while (thermostat && !input.empty()) {
    clock.sleep_for(std::chrono::seconds{1});
    const std::uint8_t choice = input.byte() % 4;
    if (choice == 0) {
      (void)(*thermostat)->set_target(config::Celsius{static_cast<double>(input.number<float>())});
    } else if (choice == 1) {
      (void)(*thermostat)->set_mode(static_cast<config::HeatingMode>(input.byte() % 3));
    } else if (const auto reading = (*thermostat)->read()) {
      for (const config::Celsius t :
           {reading->working_1, reading->working_2, reading->control, reading->ambient}) {
        fuzz::require(t.value >= 0.0 && t.value <= 120.0);
      }
    }
  }
  return 0;
}
