#pragma once
// The thermostat controller, or an auxiliary sensor, as a Modbus server: holding registers at the
// addresses, types, scales and word orders of the instrument's description, over the plant's
// controller and its auxiliary quantities. A register that the description names and neither knows
// is plain memory.
//
// Exception answers as the standard has them: 2 for an address that is no register, a part of a
// number, or one that may not be read or written so; 3 for an odd count where only even ones are
// allowed and for a value outside the register's limits.

#include <map>
#include <span>
#include <string>

#include "config/device.hpp"
#include "drivers/transport.hpp"
#include "simulator/instrument_line.hpp"

namespace fogbench::simulator {

class ModbusFarEnd final : public drivers::ModbusTransport {
 public:
  static constexpr std::initializer_list<FaultKind> kFaults = {
      FaultKind::kTimeout,     FaultKind::kLateAnswer,  FaultKind::kSilentExecution,
      FaultKind::kBadChecksum, FaultKind::kBadSequence, FaultKind::kGarbage,
      FaultKind::kNan,         FaultKind::kStuck,       FaultKind::kException,
      FaultKind::kUnplug,      FaultKind::kSlowAnswer,  FaultKind::kOpenCircuit};

  ModbusFarEnd(const config::ModbusDevice& device, InstrumentLine line);

  Status read_registers(std::uint16_t address, std::span<std::uint16_t> out) override;
  Status write_registers(std::uint16_t address, std::span<const std::uint16_t> values) override;
  /// Of the last call; 0 when it did not end with an exception.
  int last_exception() const { return last_exception_; }
  bool plugged() const { return line_.plugged(); }
  void set_fault(FaultKind kind, bool on) { line_.set_fault(kind, on); }

 private:
  /// What the scenario calls a write to that address.
  std::string_view write_operation(std::uint16_t address) const;
  Status check_count(std::size_t count);
  Error exception(int code);
  double value_of(const config::RegisterSpec& spec);
  Status apply(const config::RegisterSpec& spec, double value);
  void encode(const config::RegisterSpec& spec, std::span<std::uint16_t> words);

  const config::ModbusDevice device_;
  InstrumentLine line_;
  std::map<std::uint16_t, const config::RegisterSpec*> by_address_;
  int last_exception_ = 0;
  std::map<std::string, double> memory_;  ///< last values, of registers that are plain memory too
};

}  // namespace fogbench::simulator
