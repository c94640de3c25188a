#pragma once
// What only measures, beside the measurement: any instrument of which a device file says where its
// numbers lie (config/sensor.hpp). It is reached when it is first read, and may come and go.

#include <memory>
#include <string>
#include <vector>

#include "config/bench.hpp"
#include "drivers/instruments.hpp"
#include "drivers/transport.hpp"

namespace fogbench::drivers {

/// Says nothing yet. Every channel is asked once a reading, and not again when no answer came: a
/// sensor that is slow must not keep anybody from looking after the heaters. `clock` must outlive
/// it. Errors: kBadInput for a transport of another kind than the sensor's.
Result<std::unique_ptr<AuxiliarySensor>> attach_sensor(const config::AuxiliaryConfig& config,
                                                       SensorTransport transport, Clock& clock);

}  // namespace fogbench::drivers
