#pragma once
// A thermostat controller behind Modbus holding registers, whatever its make: the register map is
// data. Neighbouring registers are read together.

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "config/device.hpp"
#include "drivers/instruments.hpp"
#include "drivers/patience.hpp"
#include "drivers/stillness.hpp"
#include "drivers/transport.hpp"

namespace fogbench::drivers {

class ModbusThermostat final : public Thermostat {
 public:
  /// Checks the map and says nothing. `name` stands in front of every message; `clock` must outlive
  /// the thermostat. Errors: kBadInput for a map that lacks a register or a mode, or that an
  /// instrument of even counts cannot answer.
  static Result<std::unique_ptr<ModbusThermostat>> attach(
      std::string name, const config::ModbusDevice& device,
      std::unique_ptr<ModbusTransport> transport, Clock& clock);

  /// Reads everything once. Errors: as read().
  Status begin() override;
  /// Modbus has no question for it: the map's name.
  Result<std::string> identity() override { return device_.name; }
  // A busy controller is asked again for as long as a command's or a reading's Patience has it,
  // then the error is kBusy with its exception.
  Status set_target(Celsius target) override;
  Status set_mode(HeatingMode mode) override;
  /// kStale when the registers took longer than the map's max_age to collect.
  Result<ThermostatReading> read() override;
  Status switch_off() override;
  /// By the heating mode, and by the heaters' power where it reads as a number.
  Status confirm_off() override;

 private:
  /// What the driver asks for, in the order of kNames.
  enum Quantity {
    kWorking1,
    kWorking2,
    kControl,
    kAmbient,
    kTarget,
    kMode,
    kBoostPower,
    kNormalPower,
    kQuantities
  };
  static const std::array<const char*, kQuantities> kNames;

  /// Consecutive registers, read in one request.
  struct Group {
    std::uint16_t address = 0;
    std::vector<std::uint16_t> words;
  };

  ModbusThermostat(std::string name, config::ModbusDevice device,
                   std::unique_ptr<ModbusTransport> transport, Clock& clock);
  Status check_map();
  void group_registers();
  Status read_words(std::uint16_t address, std::span<std::uint16_t> words,
                    const Patience& patience);
  /// kProtocol for a number that the register cannot sensibly hold.
  Result<double> value_of(const config::RegisterSpec& spec,
                          std::span<const std::uint16_t> words) const;
  Result<double> read_one(const config::RegisterSpec& spec, const Patience& patience);
  /// Writes and reads back. A write without an answer, or one that the instrument is still at work
  /// on, may have been executed, so it is repeated only after the read-back has shown that it was
  /// not.
  Status write_and_verify(const config::RegisterSpec& spec, double value);
  Result<HeatingMode> mode_of(double value) const;
  Error error(ErrorCode code, const std::string& message) const;

  std::string name_;
  config::ModbusDevice device_;
  std::unique_ptr<ModbusTransport> transport_;
  Clock& clock_;
  std::array<const config::RegisterSpec*, kQuantities> specs_{};  ///< into device_.registers
  std::vector<Group> groups_;
  StillnessWatch stillness_;
};

}  // namespace fogbench::drivers
