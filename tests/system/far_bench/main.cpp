// usage: far_bench FOLDER [BOOST]
// The far ends of a bench as a process of its own, so that what a daemon energised stays so when it
// dies. In FOLDER: bench.json, which takes fogbenchd to them; the serial lines; the magnetometer's
// socket (hid_stand_in.cpp); and the socket `control` (control_server.hpp). BOOST is what the
// thermostat's register `mode` shows while it boosts: another number than described stands for a
// mode that nobody described. Runs until it is killed.

#include <fmt/format.h>
#include <sys/eventfd.h>

#include <cstdlib>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "config/json_file.hpp"
#include "simulator/wire/gyro_server.hpp"
#include "simulator/wire/modbus_tcp_server.hpp"
#include "simulator/wire/scpi_line_server.hpp"
#include "tests/support/source_tree.hpp"
#include "tests/system/far_bench/control_server.hpp"
#include "tests/system/far_bench/hid_server.hpp"

namespace fogbench::far_bench {
namespace {

namespace fs = std::filesystem;
using simulator::PseudoTerminal;

constexpr const char* kAddress = "127.0.0.1";

/// The ready bench, its instruments where they are met here.
Status write_bench_file(const fs::path& folder, std::uint16_t modbus_port) {
  const fs::path ready = tests::source_tree() / "config/benches/simulated.json";
  const auto text = config::read_text_file(ready);
  if (!text) return text.error();
  auto bench = nlohmann::ordered_json::parse(*text);
  bench.erase("$schema");
  bench.erase("simulation");
  bench["name"] = "far";
  for (auto& [name, instrument] : bench.items()) {
    if (!instrument.is_object() || !instrument.contains("connection")) continue;
    instrument["connection"] = "tty:" + (folder / name).string();
    instrument["device"] =
        fs::canonical(ready.parent_path() / instrument["device"].get<std::string>()).string();
  }
  bench["thermostat"]["connection"] = fmt::format("tcp:{}:{}", kAddress, modbus_port);
  bench["magnetometer"]["connection"] = "hid:0x1209:0x0001:SIM-MAG-1";
  std::ofstream(folder / "bench.json") << bench.dump(2);
  return {};
}

Status serve(const fs::path& folder, double boost) {
  auto bench = config::load_bench(tests::source_tree() / "config/benches/simulated.json");
  if (!bench) return bench.error();
  bench->thermostat.device.modes["boost"] = boost;
  config::ScenarioConfig scenario;
  scenario.noise.angle_random_walk_deg_per_sqrt_h = 0.001;
  drivers::SteadyClock machine;
  simulator::DeferringClock clock(machine);
  auto ends = simulator::make_far_ends(*bench, scenario, 1, clock);
  if (!ends) return ends.error();

  std::vector<std::unique_ptr<simulator::Server>> servers;
  simulator::ModbusUnit unit(bench->thermostat.device.unit_id, *ends->thermostat, clock);
  auto listener = simulator::TcpListener::open(kAddress, 0);
  if (!listener) return listener.error();
  if (const Status written = write_bench_file(folder, listener->port()); !written) return written;
  servers.push_back(
      std::make_unique<simulator::ModbusTcpServer>(*std::move(listener), kAddress, unit, clock));
  for (const auto& [name, end] : {std::pair{"coil_horizontal", ends->coil_horizontal.get()},
                                  std::pair{"coil_vertical", ends->coil_vertical.get()},
                                  std::pair{"turntable", ends->turntable.get()}}) {
    auto terminal = PseudoTerminal::open(folder / name);
    if (!terminal) return terminal.error();
    servers.push_back(
        std::make_unique<simulator::ScpiLineServer>(*std::move(terminal), *end, clock));
  }
  auto gyro = PseudoTerminal::open(folder / "gyro");
  if (!gyro) return gyro.error();
  servers.push_back(std::make_unique<simulator::GyroServer>(
      *std::move(gyro), *ends->gyro, bench->gyro.device, clock,
      drivers::from_seconds(1.0 / bench->gyro.device.frame_rate_hz)));
  servers.push_back(std::make_unique<HidServer>(folder / "magnetometer", bench->magnetometer.device,
                                                *ends->magnetometer, clock));
  auto control = PacketListener::open(folder / "control");
  if (!control) return Error{ErrorCode::kDevice, "no control socket"};
  servers.push_back(std::make_unique<ControlServer>(std::move(*control), *bench, *ends, clock));
  fmt::print("ready\n");
  std::fflush(stdout);
  const simulator::FileDescriptor never(eventfd(0, EFD_CLOEXEC));
  return simulator::run_event_loop(servers, clock, 1.0, never.get());
}

}  // namespace
}  // namespace fogbench::far_bench

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  const auto served = fogbench::far_bench::serve(argv[1], argc > 2 ? std::atof(argv[2]) : 1.0);
  if (served) return 0;
  fmt::print(stderr, "far_bench: {}\n", served.error().message);
  return 4;
}
