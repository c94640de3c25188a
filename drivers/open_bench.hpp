#pragma once

#include "config/bench.hpp"
#include "config/result.hpp"
#include "drivers/clock.hpp"
#include "drivers/instruments.hpp"
#include "drivers/transport.hpp"

namespace fogbench::drivers {

/// Puts the drivers that `config` names on top of the transports and initialises every instrument
/// (identity checked, coil supplies at 0 A with output off). `clock` and `operator_` must outlive
/// the bench. Errors: as the instruments', with the instrument's name in the message.
Result<Bench> open_bench(const config::BenchConfig& config, Transports transports, Clock& clock,
                         Operator& operator_);

}  // namespace fogbench::drivers
