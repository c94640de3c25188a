// fogbench device probe: what an instrument says, through its description. Reads only.

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/describe_device.hpp"
#include "cli/output.hpp"
#include "config/connection.hpp"
#include "drivers/hid_port.hpp"
#include "drivers/line_messages.hpp"
#include "drivers/modbus_port.hpp"
#include "drivers/probe.hpp"
#include "drivers/serial_port.hpp"
#include "drivers/usbtmc_port.hpp"

namespace fogbench::cli {
namespace {

using drivers::ProbeReport;

struct ProbeOptions {
  std::string device;
  std::string connection;
  bool json = false;
};

/// What instruments with SCPI over a serial line are delivered with.
constexpr std::uint32_t kScpiBaud = 9600;

/// Opens what the connection names, for the kind of instrument that the description is of.
class Prober {
 public:
  Prober(const ProbeOptions& options, const config::Connection& connection)
      : options_(options), connection_(connection) {}

  Result<ProbeReport> operator()(const config::ModbusDevice& device) {
    if (const auto* tcp = std::get_if<config::TcpConnection>(&connection_)) {
      return through(drivers::open_modbus(*tcp, device.unit_id, clock_), device);
    }
    if (const auto* rtu = std::get_if<config::RtuConnection>(&connection_)) {
      return through(drivers::open_modbus(*rtu, device.unit_id, clock_), device);
    }
    return wrong("tcp: or rtu:, as of a Modbus instrument");
  }
  Result<ProbeReport> operator()(const config::ScpiDevice& device) {
    if (const auto* usb = std::get_if<config::UsbConnection>(&connection_)) {
      return through(drivers::open_usbtmc(*usb, clock_), device);
    }
    const auto* tty = std::get_if<config::TtyConnection>(&connection_);
    if (tty == nullptr) return wrong("usb: or tty:, as of a SCPI instrument");
    auto line = drivers::open_serial(tty->tty, tty->baud.value_or(kScpiBaud), clock_);
    if (!line) return line.error();
    drivers::LineMessages messages(std::move(*line), clock_);
    return drivers::probe(device, messages);
  }
  Result<ProbeReport> operator()(const config::HidDevice& device) {
    const auto* hid = std::get_if<config::HidConnection>(&connection_);
    if (hid == nullptr) return wrong("hid:, as of a HID instrument");
    return through(drivers::open_hid(*hid, clock_), device);
  }
  Result<ProbeReport> operator()(const config::FrameDevice& device) {
    const auto* tty = std::get_if<config::TtyConnection>(&connection_);
    if (tty == nullptr) return wrong("tty:, as of a gyro that streams frames");
    auto line = drivers::open_serial(tty->tty, tty->baud.value_or(device.baud), clock_);
    if (!line) return line.error();
    return drivers::probe(device, **line, clock_);
  }

 private:
  template <class Transport, class Device>
  static Result<ProbeReport> through(Result<std::unique_ptr<Transport>> transport,
                                     const Device& device) {
    if (!transport) return transport.error();
    return drivers::probe(device, **transport);
  }
  Error wrong(const char* expected) const {
    return {ErrorCode::kBadInput,
            fmt::format("--connection: found \"{}\", expected {}", options_.connection, expected)};
  }

  const ProbeOptions& options_;
  const config::Connection& connection_;
  drivers::SteadyClock clock_;
};

nlohmann::ordered_json to_json(const ProbeReport& report) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const auto& row : report.rows) {
    rows.push_back({{"name", row.name},
                    {"place", row.place},
                    {"raw", row.raw},
                    {"value", row.value ? nlohmann::ordered_json(*row.value) : nullptr},
                    {"unit", row.unit},
                    {"problem", row.problem}});
  }
  return {{"rows", rows}, {"notes", report.notes}};
}

void print(const ProbeReport& report) {
  using Align = TextTable::Align;
  TextTable table({{"quantity", "", Align::kLeft},
                   {"where", "", Align::kLeft},
                   {"raw", "", Align::kLeft},
                   {"value", ""},
                   {"unit", "", Align::kLeft},
                   {"problem", "", Align::kLeft}});
  for (const auto& row : report.rows) {
    table.add_row({row.name, row.place, row.raw, row.value ? fmt::format("{:.7g}", *row.value) : "",
                   row.unit, row.problem});
  }
  fmt::print("{}", table.text());
  for (const std::string& note : report.notes) fmt::print("{}\n", note);
}

Result<ExitStatus> run_probe(const ProbeOptions& options) {
  const auto device = read_device(options.device);
  if (!device) return device.error();
  const auto connection = config::parse_connection(options.connection);
  if (!connection) {
    return Error{connection.error().code, "--connection: " + connection.error().message};
  }
  const auto report = std::visit(Prober(options, *connection), *device);
  if (!report) return report.error();
  if (options.json) {
    print_json(to_json(*report));
  } else {
    print(*report);
  }
  const auto wrong = std::count_if(report->rows.begin(), report->rows.end(),
                                   [](const auto& row) { return !row.problem.empty(); });
  if (wrong == 0) return ExitStatus::kDone;
  return Error{ErrorCode::kDevice, fmt::format("{} of {} quantities are not as {} describes them",
                                               wrong, report->rows.size(), options.device)};
}

}  // namespace

void add_device_probe(CLI::App& device, Action& action) {
  add_command<ProbeOptions>(
      device, action, "probe",
      "Show what an instrument says, raw beside scaled; sets nothing, sends no self test",
      "  fogbench device probe thermostat-eurotherm --connection tcp:192.168.1.5:502\n"
      "  fogbench device probe coil-kepco --connection usb:0x0957:0x1234:BOP0001\n"
      "  fogbench device probe gyro-kvh --connection tty:/dev/ttyUSB1",
      [](CLI::App& command, ProbeOptions& options) {
        command.add_option("FILE", options.device, "Device file, or the name of a ready one")
            ->required();
        command.add_option("--connection", options.connection, "Where it is, as in a bench file")
            ->required();
        command.add_flag("--json", options.json, "One JSON document on stdout");
      },
      run_probe);
}

}  // namespace fogbench::cli
