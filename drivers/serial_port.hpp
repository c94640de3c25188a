#pragma once
// A serial line of the operating system: raw, eight data bits, no parity, one stop bit, at any rate
// that the adapter can make.
//
// The kernel keeps two seconds of a gyro's stream, and whoever commands a bench waits longer: for a
// turntable, for a person, for an instrument that does not answer. So a thread of the port's own,
// "serial", reads all the time and keeps what has come until it is asked for.

#include <cstdint>
#include <memory>
#include <string>

#include "config/result.hpp"
#include "drivers/clock.hpp"
#include "drivers/transport.hpp"

namespace fogbench::drivers {

/// The line, for this process alone; what it had kept is thrown away. The first call opens it:
/// while that fails, the line does not take the rate, or its adapter is gone, calls return
/// kUnplugged. `clock` must outlive the port. Errors: kHeld when another process has the line,
/// whose settings and bytes are left alone.
Result<std::unique_ptr<SerialTransport>> open_serial(const std::string& tty, std::uint32_t baud,
                                                     Clock& clock);

}  // namespace fogbench::drivers
