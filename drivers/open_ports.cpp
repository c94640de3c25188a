#include "drivers/open_ports.hpp"

#include <fmt/format.h>

#include "config/connection.hpp"
#include "config/roles.hpp"
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

Error wrong(const std::string& connection, const char* expected) {
  return {ErrorCode::kBadInput,
          fmt::format("connection: found \"{}\", expected {}", connection, expected)};
}

/// The connection, or the error that says why the text is none.
Result<config::Connection> parsed(const std::string& text) {
  auto connection = config::parse_connection(text);
  if (connection) return connection;
  return Error{connection.error().code, "connection: " + connection.error().message};
}

/// Moves what was opened to its place in the transports.
template <class Transport>
Status take(const char* name, Opened<Transport> opened, std::unique_ptr<Transport>& place) {
  if (!opened) return named(name, opened.error());
  place = std::move(*opened);
  return {};
}

Opened<ModbusTransport> open_registers(std::uint8_t unit_id, const std::string& connection,
                                       Clock& clock) {
  const auto place = parsed(connection);
  if (!place) return place.error();
  if (const auto* tcp = std::get_if<config::TcpConnection>(&*place)) {
    return open_modbus(*tcp, unit_id, clock);
  }
  if (const auto* rtu = std::get_if<config::RtuConnection>(&*place)) {
    return open_modbus(*rtu, unit_id, clock);
  }
  return wrong(connection, "tcp: or rtu:, as of a Modbus instrument");
}

Opened<MessageTransport> open_messages(const std::string& connection, Clock& clock) {
  const auto place = parsed(connection);
  if (!place) return place.error();
  if (const auto* usb = std::get_if<config::UsbConnection>(&*place)) {
    return open_usbtmc(*usb, clock);
  }
  if (const auto* tty = std::get_if<config::TtyConnection>(&*place)) {
    auto serial = open_serial(tty->tty, tty->baud.value_or(kScpiBaud), clock);
    if (!serial) return serial.error();
    return Opened<MessageTransport>(std::make_unique<LineMessages>(std::move(*serial), clock));
  }
  return wrong(connection, "usb: or tty:, as of a SCPI instrument");
}

Opened<HidTransport> open_reports(const std::string& connection, Clock& clock) {
  const auto place = parsed(connection);
  if (!place) return place.error();
  if (const auto* hid = std::get_if<config::HidConnection>(&*place)) {
    return open_hid(*hid, clock);
  }
  return wrong(connection, "hid:, as of a HID instrument");
}

Opened<SerialTransport> open_stream(std::uint32_t usual_baud, const std::string& connection,
                                    Clock& clock) {
  const auto place = parsed(connection);
  if (!place) return place.error();
  if (const auto* tty = std::get_if<config::TtyConnection>(&*place)) {
    return open_serial(tty->tty, tty->baud.value_or(usual_baud), clock);
  }
  return wrong(connection, "tty:, as of what streams by itself");
}

}  // namespace

Opened<ModbusTransport> open_port(const config::ModbusDevice& device, const std::string& connection,
                                  Clock& clock) {
  return open_registers(device.unit_id, connection, clock);
}
Opened<ModbusTransport> open_port(const config::ModbusSensor& device, const std::string& connection,
                                  Clock& clock) {
  return open_registers(device.unit_id, connection, clock);
}
Opened<MessageTransport> open_port(const config::ScpiDevice&, const std::string& connection,
                                   Clock& clock) {
  return open_messages(connection, clock);
}
Opened<MessageTransport> open_port(const config::ScpiSensor&, const std::string& connection,
                                   Clock& clock) {
  return open_messages(connection, clock);
}
Opened<HidTransport> open_port(const config::HidDevice&, const std::string& connection,
                               Clock& clock) {
  return open_reports(connection, clock);
}
Opened<HidTransport> open_port(const config::HidSensor&, const std::string& connection,
                               Clock& clock) {
  return open_reports(connection, clock);
}
Opened<SerialTransport> open_port(const config::FrameDevice& device, const std::string& connection,
                                  Clock& clock) {
  return open_stream(device.baud, connection, clock);
}
Opened<SerialTransport> open_port(const config::LineSensor& device, const std::string& connection,
                                  Clock& clock) {
  return open_stream(device.baud, connection, clock);
}

Result<Transports> open_ports(const config::BenchConfig& config, Clock& clock) {
  Transports t;
  Status status;
  config::for_each_role(
      [&](const char* role, const auto& its, auto& place) {
        const auto* device = config::device_of(its);
        if (!status || device == nullptr) return;
        status = take(role, open_port(*device, its.connection, clock), place);
      },
      config, t);
  if (!status) return status.error();
  for (const config::AuxiliaryConfig& sensor : config.auxiliary) {
    const auto open_sensor = [&](const auto& device) -> Status {
      auto port = open_port(device, sensor.connection, clock);
      if (!port) return named(sensor.name, port.error());
      t.auxiliary.emplace_back(std::move(*port));
      return {};
    };
    status = std::visit(open_sensor, sensor.device);
    if (!status) return status.error();
  }
  return t;
}

}  // namespace fogbench::drivers
