#pragma once

#include "config/bench.hpp"
#include "config/result.hpp"
#include "drivers/clock.hpp"
#include "drivers/instruments.hpp"
#include "drivers/transport.hpp"

namespace fogbench::drivers {

/// Puts the drivers that `config` names on top of the transports, and says nothing to any
/// instrument. `clock` and `operator_` must outlive the bench. Errors: kBadInput for a description
/// that its driver cannot work with; kDevice for an instrument without a transport; with the
/// instrument's name in front.
Result<Bench> attach_bench(const config::BenchConfig& config, Transports transports, Clock& clock,
                           Operator& operator_);

/// Begins every instrument, the others too when one fails: identity checked, coil supplies at 0 A
/// with their outputs off. May be repeated. The error is the first one, with those of the other
/// instruments behind it. Auxiliary sensors begin when they are first read: nothing waits for them.
Status begin_bench(const Bench& bench);

/// Attached and begun.
Result<Bench> open_bench(const config::BenchConfig& config, Transports transports, Clock& clock,
                         Operator& operator_);

}  // namespace fogbench::drivers
