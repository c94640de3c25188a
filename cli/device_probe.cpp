// fogbench device probe: what an instrument says, through its description. Reads only.

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <type_traits>

#include "cli/command.hpp"
#include "cli/describe_device.hpp"
#include "cli/output.hpp"
#include "drivers/open_ports.hpp"
#include "drivers/probe.hpp"

namespace fogbench::cli {
namespace {

using drivers::ProbeReport;

struct ProbeOptions {
  std::string device;
  std::string connection;
  bool json = false;
};

/// Opens what the connection names, for the kind of instrument that the description is of, and
/// asks.
template <class Device>
Result<ProbeReport> probe_at(const Device& device, const std::string& connection) {
  drivers::SteadyClock clock;
  const auto port = drivers::open_port(device, connection, clock);
  if (!port) return port.error();
  if constexpr (std::is_same_v<Device, config::FrameDevice>) {
    return drivers::probe(device, **port, clock);  // a stream is listened to for a while
  } else {
    return drivers::probe(device, **port);
  }
}

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
  const auto report =
      std::visit([&](const auto& its) { return probe_at(its, options.connection); }, *device);
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
