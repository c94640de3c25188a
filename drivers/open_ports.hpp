#pragma once

#include <memory>
#include <string>

#include "config/bench.hpp"
#include "config/device.hpp"
#include "config/result.hpp"
#include "drivers/clock.hpp"
#include "drivers/transport.hpp"

namespace fogbench::drivers {

/// The way to an instrument of the described kind at `connection`, written as in a bench file; the
/// first call opens it. `clock` must outlive the transport. Errors: kBadInput ("connection: found
/// ..., expected ...") for a connection that cannot be read or that no instrument of the kind has.
Result<std::unique_ptr<ModbusTransport>> open_port(const config::ModbusDevice& device,
                                                   const std::string& connection, Clock& clock);
Result<std::unique_ptr<MessageTransport>> open_port(const config::ScpiDevice& device,
                                                    const std::string& connection, Clock& clock);
Result<std::unique_ptr<HidTransport>> open_port(const config::HidDevice& device,
                                                const std::string& connection, Clock& clock);
Result<std::unique_ptr<SerialTransport>> open_port(const config::FrameDevice& device,
                                                   const std::string& connection, Clock& clock);

Result<std::unique_ptr<ModbusTransport>> open_port(const config::ModbusSensor& device,
                                                   const std::string& connection, Clock& clock);
Result<std::unique_ptr<MessageTransport>> open_port(const config::ScpiSensor& device,
                                                    const std::string& connection, Clock& clock);
Result<std::unique_ptr<HidTransport>> open_port(const config::HidSensor& device,
                                                const std::string& connection, Clock& clock);
Result<std::unique_ptr<SerialTransport>> open_port(const config::LineSensor& device,
                                                   const std::string& connection, Clock& clock);

/// The ways to all instruments of a bench, whoever is there. `clock` must outlive the transports.
/// Errors: as open_port, with the instrument's name in front; a simulated instrument is one too.
/// Precondition: a motorised turntable has its description.
Result<Transports> open_ports(const config::BenchConfig& config, Clock& clock);

}  // namespace fogbench::drivers
