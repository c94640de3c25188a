#pragma once
// Modbus over TCP or a serial line (RTU), by libmodbus.
//
// An answer is taken only when it is of the unit, the function and the registers that were asked
// for, and a late one never for the next one. On TCP each answer has its request's number, and
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

/// The way to the instrument with the address `unit`, over TCP 0 and 255 for whoever listens there,
/// which the first call opens: kUnplugged while nobody is there, or the line cannot be opened.
/// `clock` must outlive the port. Errors: kHeld when another process has the unit or the line;
/// kBadInput for an address that nobody has on a serial line.
Result<std::unique_ptr<ModbusTransport>> open_modbus(const config::TcpConnection& connection,
                                                     std::uint8_t unit, Clock& clock);
Result<std::unique_ptr<ModbusTransport>> open_modbus(const config::RtuConnection& connection,
                                                     std::uint8_t unit, Clock& clock);

}  // namespace fogbench::drivers
