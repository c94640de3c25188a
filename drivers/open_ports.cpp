#include "drivers/open_ports.hpp"

#include <fmt/format.h>

#include "config/connection.hpp"
#include "drivers/hid_port.hpp"
#include "drivers/line_messages.hpp"
#include "drivers/modbus_port.hpp"
#include "drivers/named_error.hpp"
#include "drivers/serial_port.hpp"
#include "drivers/usbtmc_port.hpp"

namespace fogbench::drivers {
namespace {

/// What instruments with SCPI over a serial line are delivered with.
constexpr std::uint32_t kScpiBaud = 9600;

template <class Transport>
using Opened = Result<std::unique_ptr<Transport>>;

Error wrong(const config::InstrumentConfig& instrument, const char* expected) {
  return {ErrorCode::kBadInput,
          fmt::format("connection: found \"{}\", expected {}", instrument.connection, expected)};
}

Opened<ModbusTransport> open_thermostat(const config::ThermostatConfig& thermostat, Clock& clock) {
  const auto connection = config::parse_connection(thermostat.connection);
  if (!connection) return connection.error();
  const std::uint8_t unit = thermostat.device.unit_id;
  if (const auto* tcp = std::get_if<config::TcpConnection>(&*connection)) {
    return open_modbus(*tcp, unit, clock);
  }
  if (const auto* rtu = std::get_if<config::RtuConnection>(&*connection)) {
    return open_modbus(*rtu, unit, clock);
  }
  return wrong(thermostat, "tcp: or rtu:, as of a real bench");
}

Opened<MessageTransport> open_scpi(const config::InstrumentConfig& instrument, Clock& clock) {
  const auto connection = config::parse_connection(instrument.connection);
  if (!connection) return connection.error();
  if (const auto* usb = std::get_if<config::UsbConnection>(&*connection)) {
    return open_usbtmc(*usb, clock);
  }
  if (const auto* tty = std::get_if<config::TtyConnection>(&*connection)) {
    auto serial = open_serial(tty->tty, tty->baud.value_or(kScpiBaud), clock);
    if (!serial) return serial.error();
    return Opened<MessageTransport>(std::make_unique<LineMessages>(std::move(*serial), clock));
  }
  return wrong(instrument, "usb: or tty:, as of a real bench");
}

Opened<HidTransport> open_magnetometer(const config::InstrumentConfig& magnetometer, Clock& clock) {
  const auto connection = config::parse_connection(magnetometer.connection);
  if (!connection) return connection.error();
  if (const auto* hid = std::get_if<config::HidConnection>(&*connection)) {
    return open_hid(*hid, clock);
  }
  return wrong(magnetometer, "hid:, as of a real bench");
}

Opened<SerialTransport> open_gyro(const config::GyroConfig& gyro, Clock& clock) {
  const auto connection = config::parse_connection(gyro.connection);
  if (!connection) return connection.error();
  if (const auto* tty = std::get_if<config::TtyConnection>(&*connection)) {
    return open_serial(tty->tty, tty->baud.value_or(gyro.device.baud), clock);
  }
  return wrong(gyro, "tty:, as of a real bench");
}

/// Moves what was opened to its place in the transports.
template <class Transport>
Status take(const char* name, Opened<Transport> opened, std::unique_ptr<Transport>& place) {
  if (!opened) return named(name, opened.error());
  place = std::move(*opened);
  return {};
}

}  // namespace

Result<Transports> open_ports(const config::BenchConfig& config, Clock& clock) {
  Transports t;
  Status status =
      take("coil_horizontal", open_scpi(config.coil_horizontal, clock), t.coil_horizontal);
  if (status)
    status = take("coil_vertical", open_scpi(config.coil_vertical, clock), t.coil_vertical);
  if (status) status = take("thermostat", open_thermostat(config.thermostat, clock), t.thermostat);
  if (status) {
    status = take("magnetometer", open_magnetometer(config.magnetometer, clock), t.magnetometer);
  }
  if (status && config.turntable.motorised) {
    status = take("turntable", open_scpi(config.turntable, clock), t.turntable);
  }
  if (status) status = take("gyro", open_gyro(config.gyro, clock), t.gyro);
  if (!status) return status.error();
  return t;
}

}  // namespace fogbench::drivers
