// fogbench simulate --serve: the simulated bench at the wire.

#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/output.hpp"
#include "cli/served_bench_file.hpp"
#include "cli/shell_word.hpp"
#include "config/output_file.hpp"
#include "config/paths.hpp"
#include "config/scratch_folder.hpp"
#include "daemon/run_options.hpp"
#include "daemon/session.hpp"
#include "daemon/stop_signals.hpp"
#include "simulator/wire/served_bench.hpp"

namespace fogbench::cli {

using simulator::ServedBench;
using simulator::ServedInstrument;

namespace {

/// What usbip takes when it is told none.
constexpr std::uint16_t kUsbipPort = 3240;
/// 502 is Modbus TCP's own, and the superuser's.
constexpr std::uint16_t kModbusPort = 1502;

struct SimulateOptions {
  bool serve = false;
  daemon::SetupOptions setup;
  std::optional<std::uint64_t> seed;
  double speed = 1.0;
  std::string listen = "127.0.0.1";
  std::uint16_t modbus_port = kModbusPort;
  std::uint16_t usbip_port = kUsbipPort;
  std::string write_bench;
  bool json = false;
};

/// The command that makes the kernel take the device.
std::string attach_command(const ServedInstrument& instrument, const std::string& address,
                           std::uint16_t port) {
  const std::string with_port = port == kUsbipPort ? "" : fmt::format(" --tcp-port {}", port);
  return fmt::format("usbip{} attach --remote {} --busid {}", with_port, address,
                     instrument.bus_id);
}

void print_served(const ServedBench& bench, const SimulateOptions& options, const std::string& name,
                  std::uint64_t seed) {
  const std::string pace = options.speed == 1.0
                               ? "in real time"
                               : fmt::format("{} times as fast as real", options.speed);
  fmt::print("bench {}, {}; scenario {}, seed {}\n\n", name, pace, options.setup.scenario, seed);
  TextTable table({{"instrument", "", TextTable::Align::kLeft},
                   {"where it is met", "", TextTable::Align::kLeft}});
  for (const ServedInstrument& instrument : bench.instruments()) {
    table.add_row({instrument.name, instrument.connection});
    if (!instrument.also.empty()) table.add_row({"", instrument.also});
  }
  fmt::print("{}\n", table.text());
  fmt::print("The USB devices come over the network, from USB/IP at {}:{}. As root:\n",
             options.listen, bench.usbip_port());
  fmt::print("  modprobe vhci-hcd\n");
  for (const ServedInstrument& instrument : bench.instruments()) {
    if (instrument.bus_id.empty()) continue;
    fmt::print("  {}  # {}\n", attach_command(instrument, options.listen, bench.usbip_port()),
               instrument.name);
  }
  if (options.write_bench.empty()) {
    fmt::print("--write-bench FILE writes the bench that fogbenchd --bench FILE takes.\n");
  } else {
    fmt::print("Next: fogbenchd --bench {} coil-sweep\n", shell_word(options.write_bench));
  }
  fmt::print("Ctrl-C ends it.\n");
}

void print_served_json(const ServedBench& bench, const SimulateOptions& options,
                       const std::string& name, std::uint64_t seed) {
  nlohmann::ordered_json document{
      {"bench", name},
      {"scenario", options.setup.scenario},
      {"seed", seed},
      {"speed", options.speed},
      {"usbip", {{"host", options.listen}, {"port", bench.usbip_port()}}}};
  for (const ServedInstrument& instrument : bench.instruments()) {
    auto& entry = document["instruments"][instrument.name];
    entry["connection"] = instrument.connection;
    if (!instrument.also.empty()) entry["also"] = instrument.also;
    if (instrument.bus_id.empty()) continue;
    entry["bus_id"] = instrument.bus_id;
    entry["attach"] = attach_command(instrument, options.listen, bench.usbip_port());
  }
  print_json(document);
}

Status write_bench(const SimulateOptions& options, const ServedBench& bench, double frame_rate_hz) {
  const auto file = config::find_config("benches", options.setup.bench);
  if (!file) return file.error();
  const auto json = served_bench_json(*file, bench.instruments(), frame_rate_hz);
  if (!json) return json.error();
  return config::write_file(options.write_bench, *json);
}

Result<ExitStatus> run_simulate(const SimulateOptions& options) {
  const auto setup = daemon::load_setup(options.setup);
  if (!setup) return setup.error();
  const std::uint64_t seed = options.seed.value_or(daemon::random_seed());
  drivers::SteadyClock machine;
  const daemon::StopSignals stop(machine);
  // Where the links to the serial lines stand while the bench is served.
  const auto ttys = config::ScratchFolder::make();
  if (!ttys) return ttys.error();
  const drivers::SteadyClock clock(options.speed);
  const auto bench = ServedBench::open(setup->bench, setup->scenario, seed,
                                       {.address = options.listen,
                                        .modbus_port = options.modbus_port,
                                        .usbip_port = options.usbip_port,
                                        .tty_folder = ttys->path(),
                                        .speed = options.speed},
                                       clock);
  if (!bench) return bench.error();
  if (!options.write_bench.empty()) {
    const double frame_rate_hz = setup->bench.gyro.device.frame_rate_hz * options.speed;
    if (const Status s = write_bench(options, **bench, frame_rate_hz); !s) return s.error();
  }
  const auto print = options.json ? print_served_json : print_served;
  print(**bench, options, setup->bench.name, seed);
  std::fflush(stdout);
  if (const Status s = (*bench)->run(stop.descriptor()); !s) return s.error();
  return ExitStatus::kDone;
}

}  // namespace

void add_simulate(CLI::App& app, Action& action) {
  add_command<SimulateOptions>(
      app, action, "simulate", "Serve the simulated bench to real drivers: Modbus, serial, USB",
      "  fogbench simulate --serve --write-bench served.json\n"
      "  fogbenchd --bench served.json coil-sweep      in another terminal\n"
      "  fogbench simulate --serve --scenario hysteresis-z --speed 10\n"
      "It serves until it is interrupted. fogbench dry-run needs none of this.",
      [](CLI::App& command, SimulateOptions& options) {
        command.add_flag("--serve", options.serve, "At the wire, until interrupted")->required();
        command.add_option("--bench", options.setup.bench,
                           "A bench file, or a ready one (default: simulated)");
        command.add_option(
            "--scenario", options.setup.scenario,
            "What the simulated gyro hides: a file, or a ready one (default: clean)");
        daemon::add_seed_option(command, options.seed);
        command
            .add_option("--speed", options.speed,
                        "Times as fast as real, the gyro's stream too (default: 1)")
            ->check(CLI::Range(0.01, 1000.0));
        command.add_option("--listen", options.listen,
                           "Address of this machine to serve at (default: 127.0.0.1)");
        command.add_option("--modbus-port", options.modbus_port,
                           "Of Modbus TCP; 0: any that is free (default: 1502)");
        command.add_option("--usbip-port", options.usbip_port,
                           "Of USB/IP; 0: any that is free (default: 3240)");
        command.add_option("--write-bench", options.write_bench,
                           "Write a bench file that meets this bench");
        command.add_flag("--json", options.json, "Print one JSON document, then serve");
      },
      run_simulate);
}

}  // namespace fogbench::cli
