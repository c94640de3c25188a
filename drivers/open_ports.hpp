#pragma once

#include "config/bench.hpp"
#include "config/result.hpp"
#include "drivers/clock.hpp"
#include "drivers/transport.hpp"

namespace fogbench::drivers {

/// Reaches every instrument of a bench where it is connected, each within its own deadline. `clock`
/// must outlive the transports. Errors: kBadInput for an instrument that is simulated: a bench is
/// reached either as a whole or not at all; else as the ports', with the instrument's name in
/// front.
Result<Transports> open_ports(const config::BenchConfig& config, Clock& clock);

}  // namespace fogbench::drivers
