#include "simulator/wire/served_bench.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>

#include "simulator/wire/gyro_server.hpp"
#include "simulator/wire/hid_device.hpp"
#include "simulator/wire/line_server.hpp"
#include "simulator/wire/modbus_rtu_server.hpp"
#include "simulator/wire/modbus_tcp_server.hpp"
#include "simulator/wire/scpi_line_server.hpp"
#include "simulator/wire/usbip_server.hpp"
#include "simulator/wire/usbtmc_device.hpp"

namespace fogbench::simulator {
namespace {

using namespace std::chrono_literals;

/// pid.codes keeps 0x1209:0x0001 to 0x0010 for tests: what a device is that nobody gave numbers.
constexpr std::uint16_t kTestVendor = 0x1209;
constexpr std::uint16_t kTestMagnetometer = 0x0001;
constexpr std::uint16_t kTestSupply = 0x0002;

constexpr std::string_view kUsualBaud = "9600";

/// Past any host's deadline that is near the far ends' own.
constexpr drivers::Clock::Duration kLateBy = 250ms;

/// The parts of "usb:0x0957:0x1234:SERIAL"; the last one takes the rest.
std::vector<std::string> parts_of(const std::string& connection, std::size_t most) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  while (parts.size() + 1 < most) {
    const std::size_t colon = connection.find(':', begin);
    if (colon == std::string::npos) break;
    parts.push_back(connection.substr(begin, colon - begin));
    begin = colon + 1;
  }
  parts.push_back(connection.substr(begin));
  return parts;
}

/// 0 for what is no number of 16 bits in hexadecimal.
std::uint16_t usb_id_of(std::string_view text) {
  if (text.starts_with("0x")) text.remove_prefix(2);
  std::uint16_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
  return error == std::errc{} && end == text.data() + text.size() ? value : 0;
}

/// Numbers and serial number from the bench's own connection when it names a USB device; the given
/// ones otherwise.
UsbIdentity identity_of(const char* name, const config::InstrumentConfig& instrument,
                        const std::string& product, std::uint16_t vendor_id,
                        std::uint16_t product_id) {
  UsbIdentity identity{.vendor_id = vendor_id,
                       .product_id = product_id,
                       .manufacturer = "fogbench simulated bench",
                       .product = product,
                       .serial = instrument.serial_number};
  const auto parts = parts_of(instrument.connection, 4);
  if (parts.size() == 4 && (parts[0] == "usb" || parts[0] == "hid")) {
    identity.vendor_id = usb_id_of(parts[1]);
    identity.product_id = usb_id_of(parts[2]);
    identity.serial = parts[3];
  }
  if (identity.serial.empty()) identity.serial = name;
  return identity;
}

std::string connection_to(const char* scheme, const UsbIdentity& identity) {
  return fmt::format("{}:0x{:04x}:0x{:04x}:{}", scheme, identity.vendor_id, identity.product_id,
                     identity.serial);
}

}  // namespace

Result<std::unique_ptr<ServedBench>> ServedBench::open(const config::BenchConfig& config,
                                                       const config::ScenarioConfig& scenario,
                                                       std::uint64_t seed,
                                                       const ServeOptions& options,
                                                       const drivers::Clock& machine) {
  std::unique_ptr<ServedBench> bench(new ServedBench(machine, options.speed));
  Result<FarEnds> ends = make_far_ends(config, scenario, seed, bench->clock_, kLateBy);
  if (!ends) return ends.error();
  bench->ends_ = *std::move(ends);
  const config::ThermostatConfig& thermostat = config.thermostat;
  if (Status s = bench->serve_modbus("thermostat", thermostat.connection, thermostat.device.unit_id,
                                     *bench->ends_.thermostat, options.modbus_port, options);
      !s) {
    return s.error();
  }
  if (Status s = bench->serve_usb(config, options); !s) return s.error();
  if (Status s = bench->serve_lines(config, options); !s) return s.error();
  if (Status s = bench->serve_auxiliary(config, options); !s) return s.error();
  return bench;
}

Status ServedBench::serve_modbus(const std::string& name, const std::string& connection,
                                 std::uint8_t unit_id, ModbusFarEnd& far_end, std::uint16_t port,
                                 const ServeOptions& options) {
  ModbusUnit& unit = *units_.emplace_back(std::make_unique<ModbusUnit>(unit_id, far_end, clock_));
  Result<TcpListener> listener = TcpListener::open(options.address, port);
  if (!listener) return listener.error();
  Result<PseudoTerminal> terminal = PseudoTerminal::open(options.tty_folder / name);
  if (!terminal) return terminal.error();
  const auto parts = parts_of(connection, 3);
  const bool has_baud = parts.size() == 3 && parts[0] == "rtu";
  instruments_.push_back({.name = name,
                          .connection = fmt::format("tcp:{}:{}", options.address, listener->port()),
                          .also = fmt::format("rtu:{}:{}", terminal->link().string(),
                                              has_baud ? std::string_view(parts[2]) : kUsualBaud)});
  servers_.push_back(
      std::make_unique<ModbusTcpServer>(*std::move(listener), options.address, unit, clock_));
  servers_.push_back(std::make_unique<ModbusRtuServer>(*std::move(terminal), unit, clock_));
  return {};
}

Status ServedBench::serve_usb(const config::BenchConfig& config, const ServeOptions& options) {
  std::vector<ExportedDevice> devices;
  const auto serve = [&](const char* name, const char* scheme, std::unique_ptr<UsbDevice> device) {
    const std::string bus_id = fmt::format("1-{}", devices.size() + 1);
    instruments_.push_back({.name = name,
                            .connection = connection_to(scheme, device->description().identity),
                            .also = "",
                            .bus_id = bus_id});
    devices.push_back({bus_id, std::move(device)});
  };
  const auto supply = [&](const char* name, const config::CoilConfig& coil, ScpiFarEnd& far_end) {
    const UsbIdentity identity =
        identity_of(name, coil, coil.device.name, kTestVendor, kTestSupply);
    serve(name, "usb", std::make_unique<UsbtmcDevice>(identity, far_end, clock_));
  };
  supply("coil_horizontal", config.coil_horizontal, *ends_.coil_horizontal);
  supply("coil_vertical", config.coil_vertical, *ends_.coil_vertical);
  if (instruments_.back().connection == (instruments_.end() - 2)->connection) {
    return Error{
        ErrorCode::kBadInput,
        fmt::format("bench: coil_horizontal and coil_vertical are both {}: expected serial "
                    "numbers that tell them apart",
                    instruments_.back().connection)};
  }
  const config::HidDevice& magnetometer = config.magnetometer.device;
  const bool numbered = magnetometer.vendor_id != 0;
  const UsbIdentity identity = identity_of("magnetometer", config.magnetometer, magnetometer.name,
                                           numbered ? magnetometer.vendor_id : kTestVendor,
                                           numbered ? magnetometer.product_id : kTestMagnetometer);
  serve("magnetometer", "hid",
        std::make_unique<HidUsbDevice>(identity, magnetometer, *ends_.magnetometer, clock_));

  for (std::size_t i = 0; i < config.auxiliary.size(); ++i) {
    const config::AuxiliaryConfig& sensor = config.auxiliary[i];
    const char* const name = sensor.name.c_str();
    if (const auto* hid = std::get_if<config::HidSensor>(&sensor.device)) {
      auto& far_end = *std::get<std::unique_ptr<HidFarEnd>>(ends_.auxiliary[i].end);
      const UsbIdentity its = identity_of(name, sensor, hid->name, hid->vendor_id, hid->product_id);
      serve(name, "hid", std::make_unique<HidUsbDevice>(its, hid->layout(), far_end, clock_));
    } else if (sensor.connection.starts_with("usb:")) {
      auto& far_end = *std::get<std::unique_ptr<ScpiFarEnd>>(ends_.auxiliary[i].end);
      const UsbIdentity its =
          identity_of(name, sensor, name_of(sensor.device), kTestVendor, kTestSupply);
      serve(name, "usb", std::make_unique<UsbtmcDevice>(its, far_end, clock_));
    }
  }

  Result<TcpListener> listener = TcpListener::open(options.address, options.usbip_port);
  if (!listener) return listener.error();
  usbip_port_ = listener->port();
  servers_.push_back(std::make_unique<UsbipServer>(*std::move(listener), std::move(devices)));
  return {};
}

Status ServedBench::serve_auxiliary(const config::BenchConfig& config,
                                    const ServeOptions& options) {
  for (std::size_t i = 0; i < config.auxiliary.size(); ++i) {
    const config::AuxiliaryConfig& sensor = config.auxiliary[i];
    auto& end = ends_.auxiliary[i].end;
    if (const auto* modbus = std::get_if<config::ModbusSensor>(&sensor.device)) {
      const Status served = serve_modbus(sensor.name, sensor.connection, modbus->unit_id,
                                         *std::get<std::unique_ptr<ModbusFarEnd>>(end), 0, options);
      if (!served) return served;
      continue;
    }
    const auto* const lines = std::get_if<config::LineSensor>(&sensor.device);
    const bool on_usb = std::holds_alternative<config::HidSensor>(sensor.device) ||
                        sensor.connection.starts_with("usb:");
    if (on_usb) continue;
    Result<PseudoTerminal> terminal = PseudoTerminal::open(options.tty_folder / sensor.name);
    if (!terminal) return terminal.error();
    instruments_.push_back({.name = sensor.name, .connection = "tty:" + terminal->link().string()});
    if (lines != nullptr) {
      servers_.push_back(std::make_unique<LineServer>(
          *std::move(terminal), *std::get<std::unique_ptr<LineFarEnd>>(end), clock_,
          drivers::from_seconds(lines->period.count())));
    } else {
      servers_.push_back(std::make_unique<ScpiLineServer>(
          *std::move(terminal), *std::get<std::unique_ptr<ScpiFarEnd>>(end), clock_));
    }
  }
  return {};
}

Status ServedBench::serve_lines(const config::BenchConfig& config, const ServeOptions& options) {
  const auto tty = [this](const char* name, const PseudoTerminal& terminal) {
    instruments_.push_back({.name = name, .connection = "tty:" + terminal.link().string()});
  };
  Result<PseudoTerminal> turntable = PseudoTerminal::open(options.tty_folder / "turntable");
  if (!turntable) return turntable.error();
  tty("turntable", *turntable);
  servers_.push_back(
      std::make_unique<ScpiLineServer>(*std::move(turntable), *ends_.turntable, clock_));

  Result<PseudoTerminal> gyro = PseudoTerminal::open(options.tty_folder / "gyro");
  if (!gyro) return gyro.error();
  tty("gyro", *gyro);
  // A frame at a time, but the machine is not woken more often than every millisecond.
  const auto frame = drivers::from_seconds(1.0 / config.gyro.device.frame_rate_hz);
  const auto millisecond = drivers::from_seconds(1e-3 * options.speed);
  servers_.push_back(std::make_unique<GyroServer>(*std::move(gyro), *ends_.gyro, config.gyro.device,
                                                  clock_, std::max(frame, millisecond)));
  return {};
}

}  // namespace fogbench::simulator
