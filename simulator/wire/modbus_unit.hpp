#pragma once
// The thermostat controller behind its Modbus framings: requests in, answers out, one at a time.

#include <optional>

#include "simulator/modbus_far_end.hpp"
#include "simulator/wire/deferring_clock.hpp"
#include "simulator/wire/modbus_protocol.hpp"

namespace fogbench::simulator {

struct ModbusAnswer {
  Bytes content;        ///< function code first; empty when the unit is silent
  bool spoilt = false;  ///< it arrives broken
  bool gone = false;    ///< the request pulled the plug
  drivers::Clock::Instant due{};
};

class ModbusUnit {
 public:
  /// `far_end` and the clock that it sleeps on must outlive the unit.
  ModbusUnit(std::uint8_t id, ModbusFarEnd& far_end, DeferringClock& clock)
      : id_(id), far_end_(far_end), clock_(clock) {}

  std::uint8_t id() const { return id_; }
  bool plugged() const { return far_end_.plugged(); }
  /// Until then it hears nobody else, whichever line they are on.
  drivers::Clock::Instant busy_until() const { return busy_until_; }

  /// Executes what a frame carries; precondition: the content is not empty.
  ModbusAnswer execute(ByteView content);

 private:
  const std::uint8_t id_;
  ModbusFarEnd& far_end_;
  DeferringClock& clock_;
  drivers::Clock::Instant busy_until_{};
};

}  // namespace fogbench::simulator
