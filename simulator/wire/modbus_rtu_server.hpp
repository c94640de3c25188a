#pragma once
// The thermostat controller on Modbus RTU over a pseudo-terminal. What is not addressed to the
// unit, or has a wrong check value, meets silence, as the standard wants it.

#include "simulator/wire/modbus_unit.hpp"
#include "simulator/wire/pseudo_terminal.hpp"

namespace fogbench::simulator {

class ModbusRtuServer final : public Server {
 public:
  /// `unit` and `clock` must outlive the server.
  ModbusRtuServer(PseudoTerminal terminal, ModbusUnit& unit, const drivers::Clock& clock)
      : terminal_(std::move(terminal)), unit_(unit), clock_(clock) {}

  void enlist(drivers::PollSet& set) const override;
  void serve(const drivers::PollSet& happened) override;

 private:
  /// Sends the answer on its way and takes the next frame; false when there is nothing to do now.
  bool go_on();
  void execute(const ModbusFrame& frame);
  void forget();

  PseudoTerminal terminal_;
  ModbusUnit& unit_;
  const drivers::Clock& clock_;
  Bytes input_;
  drivers::Clock::Instant heard_{};  ///< when the last byte came
  Bytes answer_;                     ///< on its way until due_
  drivers::Clock::Instant due_{};
};

}  // namespace fogbench::simulator
