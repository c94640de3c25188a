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

/// Opens the line for this process alone and throws away what it had kept. When the adapter goes,
/// calls return kUnplugged until its path is there again. `clock` must outlive the port. Errors:
/// kUnplugged when the line cannot be opened or does not take the rate.
Result<std::unique_ptr<SerialTransport>> open_serial(const std::string& tty, std::uint32_t baud,
                                                     Clock& clock);

}  // namespace fogbench::drivers
