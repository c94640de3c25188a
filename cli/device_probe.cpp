// fogbench device probe: what an instrument says, through its description. Reads only.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <type_traits>

#include "cli/command.hpp"
#include "cli/describe_device.hpp"
#include "cli/output.hpp"
#include "config/bench.hpp"
#include "config/device_file.hpp"
#include "config/json_file.hpp"
#include "config/paths.hpp"
#include "config/roles.hpp"
#include "drivers/auxiliary_sensor.hpp"
#include "drivers/open_ports.hpp"
#include "drivers/probe.hpp"

namespace fogbench::cli {
namespace {

using drivers::ProbeReport;

struct ProbeOptions {
  std::string device;
  std::string connection;
  std::string bench;
  bool json = false;
};

/// The instrument that the bench calls so: its description as the bench runs it, and where it is.
Result<std::pair<config::DeviceFile, std::string>> find_in_bench(const std::string& bench_name,
                                                                 const std::string& role) {
  const auto file = config::find_config("benches", bench_name);
  if (!file) return file.error();
  const auto bench = config::load_bench(*file);
  if (!bench) return bench.error();
  std::map<std::string, std::pair<config::DeviceFile, std::string>> instruments;
  config::for_each_role(
      [&](const char* name, const auto& its) {
        const auto* device = config::device_of(its);
        if (device != nullptr) instruments[name] = {*device, its.connection};
      },
      *bench);
  for (const config::AuxiliaryConfig& sensor : bench->auxiliary) {
    instruments[sensor.name] = {
        std::visit([](const auto& d) { return config::DeviceFile(d); }, sensor.device),
        sensor.connection};
  }
  const auto found = instruments.find(role);
  if (found != instruments.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [name, instrument] : instruments) names.push_back(name);
  return config::bad_input(
      fmt::format("bench {} has no \"{}\"; it has {}", bench->name, role, fmt::join(names, ", ")));
}

/// Opens what the connection names, for the kind of instrument that the description is of, and
/// asks.
template <class Device>
Result<ProbeReport> probe_at(const Device& device, const std::string& connection) {
  drivers::SteadyClock clock;
  auto port = drivers::open_port(device, connection, clock);
  if (!port) return port.error();
  if constexpr (std::is_constructible_v<config::SensorDevice, Device>) {
    config::AuxiliaryConfig config;
    config.name = "sensor";
    config.device = device;
    auto sensor = drivers::attach_sensor(config, std::move(*port), clock);
    if (!sensor) return sensor.error();
    return drivers::probe(**sensor);
  } else if constexpr (std::is_same_v<Device, config::FrameDevice> ||
                       std::is_same_v<Device, config::ModbusDevice>) {
    return drivers::probe(device, **port, clock);  // listens for a while, or asks again
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
  std::string connection = options.connection;
  Result<config::DeviceFile> device = config::DeviceFile();
  if (options.bench.empty()) {
    device = read_device(options.device);
    if (!device) return device.error();
  } else {
    auto found = find_in_bench(options.bench, options.device);
    if (!found) return found.error();
    device = std::move(found->first);
    connection = std::move(found->second);
  }
  const auto report =
      std::visit([&](const auto& its) { return probe_at(its, connection); }, *device);
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
      "  fogbench device probe gyro-kvh --connection tty:/dev/ttyUSB1\n"
      "  fogbench device probe gyro --bench my-bench.json      at the bench's frame rate",
      [](CLI::App& command, ProbeOptions& options) {
        command
            .add_option(
                "DEVICE", options.device,
                "Device file, or the name of a ready one; with --bench, an instrument of it")
            ->required();
        auto* const where = command.add_option_group("where");
        where->add_option("--connection", options.connection, "Where it is, as in a bench file");
        where->add_option("--bench", options.bench, "The bench that says where and what it is");
        where->require_option(1);
        command.add_flag("--json", options.json, "One JSON document on stdout");
      },
      run_probe);
}

}  // namespace fogbench::cli
