// usage: far_bench FOLDER [BOOST]
// A served bench as a process of its own, so that what a daemon energised stays so when it dies. In
// FOLDER: bench.json, which takes fogbenchd to it; the serial lines; and the socket `control`
// (control_server.hpp). Its supplies are on serial lines, its magnetometer comes over USB/IP
// (hid_stand_in.cpp), at the port that is printed. BOOST is what the thermostat's register `mode`
// shows while it boosts: another number than described stands for a mode that nobody described.
// Runs until it is killed.

#include <fmt/format.h>
#include <sys/eventfd.h>

#include <cstdlib>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "config/json_file.hpp"
#include "simulator/wire/served_bench.hpp"
#include "tests/support/source_tree.hpp"
#include "tests/system/far_bench/control_server.hpp"

namespace fogbench::far_bench {
namespace {

namespace fs = std::filesystem;
using simulator::ServedBench;

/// The ready bench, its instruments where they are met here.
Status write_bench_file(const fs::path& folder, const ServedBench& served) {
  const fs::path ready = tests::source_tree() / "config/benches/simulated.json";
  const auto text = config::read_text_file(ready);
  if (!text) return text.error();
  auto bench = nlohmann::ordered_json::parse(*text);
  bench.erase("$schema");
  bench.erase("simulation");
  bench["name"] = "far";
  for (const simulator::ServedInstrument& instrument : served.instruments()) {
    auto& its = bench[instrument.name];
    its["connection"] = instrument.connection;
    its["device"] = config::device_file(ready, its["device"].get<std::string>())->string();
  }
  std::ofstream(folder / "bench.json") << bench.dump(2);
  return {};
}

Status serve(const fs::path& folder, double boost) {
  auto config = config::load_bench(tests::source_tree() / "config/benches/simulated.json");
  if (!config) return config.error();
  config->thermostat.device.modes["boost"] = boost;
  config->coil_horizontal.connection = config->coil_vertical.connection = "tty:";
  config::ScenarioConfig scenario;
  scenario.noise.angle_random_walk_deg_per_sqrt_h = 0.001;
  const drivers::SteadyClock machine;
  const auto bench = ServedBench::open(*config, scenario, 1, {.tty_folder = folder}, machine);
  if (!bench) return bench.error();
  if (const Status written = write_bench_file(folder, **bench); !written) return written;
  auto control = PacketListener::open(folder / "control");
  if (!control) return Error{ErrorCode::kDevice, "no control socket"};
  (*bench)->add(std::make_unique<ControlServer>(std::move(*control), *config, (*bench)->far_ends(),
                                                (*bench)->clock()));
  fmt::print("ready {}\n", (*bench)->usbip_port());
  std::fflush(stdout);
  const drivers::FileDescriptor never(eventfd(0, EFD_CLOEXEC));
  return (*bench)->run(never.get());
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
