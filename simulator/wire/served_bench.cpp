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
UsbIdentity identity_of(const std::string& name, const config::InstrumentConfig& instrument,
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

}  // namespace

Result<std::unique_ptr<ServedBench>> ServedBench::open(const config::BenchConfig& config,
                                                       const config::ScenarioConfig& scenario,
                                                       std::uint64_t seed,
                                                       const ServeOptions& options,
                                                       const drivers::Clock& machine) {
  std::unique_ptr<ServedBench> bench(new ServedBench(machine, options));
  Result<FarEnds> ends = make_far_ends(config, scenario, seed, bench->clock_, kLateBy);
  if (!ends) return ends.error();
  bench->ends_ = *std::move(ends);
  if (const Status served = bench->serve(config); !served) return served.error();
  return bench;
}

Status ServedBench::serve(const config::BenchConfig& config) {
  if (!config.turntable.motorised) {
    return Error{ErrorCode::kBadInput,
                 "bench: /turntable/motorised is false, expected true: nobody turns the gyro of a "
                 "served bench by hand; fogbench dry-run and fogbenchd run a procedure on it"};
  }
  Status served = serve_registers("thermostat", config.thermostat, config.thermostat.device.unit_id,
                                  *ends_.thermostat, options_.modbus_port);
  if (served) {
    served = serve_messages("coil_horizontal", config.coil_horizontal,
                            config.coil_horizontal.device.name, "usb", *ends_.coil_horizontal);
  }
  if (served) {
    served = serve_messages("coil_vertical", config.coil_vertical, config.coil_vertical.device.name,
                            "usb", *ends_.coil_vertical);
  }
  if (served && config.magnetometer.fitted) {
    served = serve_reports("magnetometer", config.magnetometer, config.magnetometer.device,
                           *ends_.magnetometer);
  }
  if (served) {
    served = serve_messages("turntable", config.turntable, config.turntable.device->name, "tty",
                            *ends_.turntable);
  }
  if (served) {
    // A frame at a time, but the machine is not woken more often than every millisecond.
    const auto frame = drivers::from_seconds(1.0 / config.gyro.device.frame_rate_hz);
    const auto millisecond = drivers::from_seconds(1e-3 * options_.speed);
    served = serve_line<GyroServer>("gyro", *ends_.gyro, config.gyro.device, clock_,
                                    std::max(frame, millisecond));
  }
  for (std::size_t i = 0; served && i < config.auxiliary.size(); ++i) {
    const config::AuxiliaryConfig& sensor = config.auxiliary[i];
    served = std::visit(
        [&](const auto& device) { return serve(sensor, device, ends_.auxiliary[i].end); },
        sensor.device);
  }
  if (!served) return served;

  Result<TcpListener> listener = TcpListener::open(options_.address, options_.usbip_port);
  if (!listener) return listener.error();
  usbip_port_ = listener->port();
  servers_.push_back(std::make_unique<UsbipServer>(*std::move(listener), std::move(usb_devices_)));
  return {};
}

template <class Device>
Status ServedBench::serve(const config::AuxiliaryConfig& sensor, const Device& device,
                          AuxiliaryEnd::End& end) {
  if constexpr (std::is_same_v<Device, config::ModbusSensor>) {
    return serve_registers(sensor.name, sensor, device.unit_id,
                           *std::get<std::unique_ptr<ModbusFarEnd>>(end), 0);
  } else if constexpr (std::is_same_v<Device, config::ScpiSensor>) {
    return serve_messages(sensor.name, sensor, device.name, "tty",
                          *std::get<std::unique_ptr<ScpiFarEnd>>(end));
  } else if constexpr (std::is_same_v<Device, config::HidSensor>) {
    return serve_reports(sensor.name, sensor, device.layout(),
                         *std::get<std::unique_ptr<HidFarEnd>>(end));
  } else {
    return serve_line<LineServer>(sensor.name, *std::get<std::unique_ptr<LineFarEnd>>(end), clock_,
                                  drivers::from_seconds(device.period.count()));
  }
}

Status ServedBench::serve_registers(const std::string& name, const config::InstrumentConfig& its,
                                    std::uint8_t unit_id, ModbusFarEnd& far_end,
                                    std::uint16_t port) {
  ModbusUnit& unit = *units_.emplace_back(std::make_unique<ModbusUnit>(unit_id, far_end, clock_));
  Result<TcpListener> listener = TcpListener::open(options_.address, port);
  if (!listener) return listener.error();
  Result<PseudoTerminal> terminal = PseudoTerminal::open(options_.tty_folder / name);
  if (!terminal) return terminal.error();
  const auto parts = parts_of(its.connection, 3);
  const bool has_baud = parts.size() == 3 && parts[0] == "rtu";
  instruments_.push_back(
      {.name = name,
       .connection = fmt::format("tcp:{}:{}", options_.address, listener->port()),
       .also = fmt::format("rtu:{}:{}", terminal->link().string(),
                           has_baud ? std::string_view(parts[2]) : kUsualBaud)});
  servers_.push_back(
      std::make_unique<ModbusTcpServer>(*std::move(listener), options_.address, unit, clock_));
  servers_.push_back(std::make_unique<ModbusRtuServer>(*std::move(terminal), unit, clock_));
  return {};
}

Status ServedBench::serve_messages(const std::string& name, const config::InstrumentConfig& its,
                                   const std::string& product, const std::string& usual,
                                   ScpiFarEnd& far_end) {
  const std::string scheme = parts_of(its.connection, 2).front();
  if ((scheme == "usb" || scheme == "tty" ? scheme : usual) == "tty") {
    return serve_line<ScpiLineServer>(name, far_end, clock_);
  }
  const UsbIdentity identity = identity_of(name, its, product, kTestVendor, kTestSupply);
  return serve_usb(name, "usb", std::make_unique<UsbtmcDevice>(identity, far_end, clock_));
}

Status ServedBench::serve_reports(const std::string& name, const config::InstrumentConfig& its,
                                  const config::HidDevice& layout, HidFarEnd& far_end) {
  const bool numbered = layout.vendor_id != 0;
  const UsbIdentity identity =
      identity_of(name, its, layout.name, numbered ? layout.vendor_id : kTestVendor,
                  numbered ? layout.product_id : kTestMagnetometer);
  return serve_usb(name, "hid", std::make_unique<HidUsbDevice>(identity, layout, far_end, clock_));
}

template <class LineServing, class FarEnd, class... Rest>
Status ServedBench::serve_line(const std::string& name, FarEnd& far_end, Rest&&... rest) {
  Result<PseudoTerminal> terminal = PseudoTerminal::open(options_.tty_folder / name);
  if (!terminal) return terminal.error();
  instruments_.push_back({.name = name, .connection = "tty:" + terminal->link().string()});
  servers_.push_back(
      std::make_unique<LineServing>(*std::move(terminal), far_end, std::forward<Rest>(rest)...));
  return {};
}

Status ServedBench::serve_usb(const std::string& name, const char* scheme,
                              std::unique_ptr<UsbDevice> device) {
  const UsbIdentity& identity = device->description().identity;
  const std::string connection = fmt::format("{}:0x{:04x}:0x{:04x}:{}", scheme, identity.vendor_id,
                                             identity.product_id, identity.serial);
  for (const ServedInstrument& other : instruments_) {
    if (other.connection != connection) continue;
    return Error{ErrorCode::kBadInput,
                 fmt::format("bench: {} and {} are both {}: expected serial numbers that tell them "
                             "apart",
                             other.name, name, connection)};
  }
  const std::string bus_id = fmt::format("1-{}", usb_devices_.size() + 1);
  instruments_.push_back({.name = name, .connection = connection, .also = "", .bus_id = bus_id});
  usb_devices_.push_back({bus_id, std::move(device)});
  return {};
}

}  // namespace fogbench::simulator
