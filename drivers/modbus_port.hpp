#pragma once
// Modbus over TCP or a serial line (RTU), by libmodbus.
//
// A late answer is never taken for the next one. On TCP each answer has its request's number, and
// after a time-out or a garbled answer the connection is closed: the next call makes a new one. RTU
// has no numbers: after a time-out the line is listened to for as long again, and whatever comes is
// thrown away; so it is before each request.

#include <cstdint>
#include <memory>

#include "config/connection.hpp"
#include "config/result.hpp"
#include "drivers/clock.hpp"
#include "drivers/transport.hpp"

namespace fogbench::drivers {

/// The way to the instrument with the address `unit`, which the first call opens: kUnplugged while
/// nobody is there, or the line cannot be opened. `clock` must outlive the port.
Result<std::unique_ptr<ModbusTransport>> open_modbus(const config::TcpConnection& connection,
                                                     std::uint8_t unit, Clock& clock);
Result<std::unique_ptr<ModbusTransport>> open_modbus(const config::RtuConnection& connection,
                                                     std::uint8_t unit, Clock& clock);

}  // namespace fogbench::drivers
