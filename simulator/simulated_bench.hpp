#pragma once
// The simulated bench: a plant with the physics of heaters, coils and gyro, and instruments that
// are the far ends of the same transports that the factory's are reached through.

#include <cstdint>
#include <memory>

#include "config/bench.hpp"
#include "config/result.hpp"
#include "config/scenario.hpp"
#include "drivers/clock.hpp"
#include "drivers/transport.hpp"

namespace fogbench::simulator {

/// Far ends of all transports over one plant, which they share and keep alive. The plant advances
/// to clock.now() whenever an instrument is spoken to; instruments take their time by sleeping on
/// the clock. Power-on of the gyro is the clock's present instant.
///
/// The same config, scenario and seed give the same bytes, bit for bit.
/// Errors: kBadInput for an effect or parameter that the simulator does not know.
Result<drivers::Transports> simulate_bench(const config::BenchConfig& config,
                                           const config::ScenarioConfig& scenario,
                                           std::uint64_t seed, drivers::Clock& clock);

}  // namespace fogbench::simulator
