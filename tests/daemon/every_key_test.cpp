// Every key of every ready bench and device file has an effect: changed, it is refused, or the
// change shows - in the plan, in the bytes on the wires, in what a probe reads, in what interlocks
// do, in what a port is opened with, in what is recorded. The list of keys without effect is empty.

#include <asm/termbits.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>

#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "config/device_file.hpp"
#include "daemon/session.hpp"
#include "drivers/crc.hpp"
#include "drivers/open_bench.hpp"
#include "drivers/open_ports.hpp"
#include "drivers/probe.hpp"
#include "procedures/interlocks.hpp"
#include "procedures/run_engine.hpp"
#include "simulator/simulated_bench.hpp"
#include "tests/daemon/key_changes.hpp"
#include "tests/daemon/pattern_instruments.hpp"
#include "tests/support/fake_transports.hpp"
#include "tests/support/memory_recorder.hpp"
#include "tests/support/own_locks.hpp"
#include "tests/support/pty.hpp"
#include "tests/support/source_tree.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/wire_tap.hpp"

namespace fogbench::daemon {
namespace {

namespace fs = std::filesystem;
using config::BenchConfig;
using config::FaultKind;
using config::Seconds;
using nlohmann::json;

const fs::path kReady = tests::source_tree() / "config";

constexpr auto kProcedure = R"({"name": "every-key", "steps": [
  {"step": "set_temperature", "target_c": 25, "mode": "boost"},
  {"step": "wait", "duration_s": 8, "segment": "w", "window_s": 2},
  {"step": "rotate", "azimuth_deg": 90},
  {"step": "compensate_field", "tolerance_ut": 0.5},
  {"step": "baseline", "duration_s": 3, "segment": "b"},
  {"step": "sweep", "axis": "z", "levels_ut": [0, 100], "duration_s": 3, "settle_s": 1,
   "segment": "z"},
  {"step": "sweep", "axis": "x", "levels_ut": [0, 100], "duration_s": 3, "settle_s": 1,
   "segment": "x"},
  {"step": "set_temperature", "target_c": 21.8, "mode": "normal"},
  {"step": "wait", "duration_s": 20},
  {"step": "set_temperature", "mode": "off"},
  {"step": "rotate", "azimuth_deg": 0},
  {"step": "prompt", "text": "Done?"}]})";

/// The same file each time, so that errors that name it are the same too.
fs::path procedure_file() {
  static const support::TemporaryFolder folder;
  static const fs::path file = folder.file("every-key.json", kProcedure);
  return file;
}

class Patient final : public drivers::Operator {
 public:
  Result<bool> confirm(const std::string&) override { return true; }
  bool can_resume() const override { return true; }
};

/// What a bench's file is, once it has been read.
struct Subject {
  fs::path file;
  Setup setup;
};

config::ScenarioConfig scenario(std::vector<config::FaultSpec> faults) {
  config::ScenarioConfig out;
  out.noise.angle_random_walk_deg_per_sqrt_h = 0.001;
  out.terms = {{"bias", 0.7}, {"magnetic_linear_z", -0.25}, {"temperature_linear", -0.1}};
  out.faults = std::move(faults);
  return out;
}

/// A bench that the operator turns is simulated with the motor of the others.
BenchConfig with_a_motor(BenchConfig bench) {
  if (bench.turntable.motorised) return bench;
  bench.turntable.motorised = true;
  bench.turntable.move_time = Seconds{20.0};
  bench.turntable.device =
      std::get<config::ScpiDevice>(*config::load_device(kReady / "devices/turntable-scpi.json"));
  return bench;
}

/// A run of the procedure: all bytes, and all that is recorded.
std::string run_of(const Subject& subject, std::vector<config::FaultSpec> faults) {
  const BenchConfig bench = with_a_motor(subject.setup.bench);
  const auto planned = plan_procedure(procedure_file(), bench, {});
  if (!planned) return planned.error().message;
  drivers::VirtualClock clock;
  Patient person;
  test::MemoryRecorder record;
  support::WireTrace trace;
  auto ends = simulator::simulate_bench(bench, scenario(std::move(faults)), 1, clock);
  if (!ends) return ends.error().message;
  auto opened = drivers::open_bench(bench, support::tapped(std::move(*ends), trace), clock, person);
  if (!opened) return opened.error().message;
  procedures::RunEngine engine(bench, *opened, clock, person, record);
  engine.on_progress([&](const procedures::Progress& now) {  // what pauses is resumed, for a while
    if (now.state == procedures::RunState::kPaused) engine.request_resume();
    if (now.elapsed > Seconds{400.0}) engine.request_abort();
  });
  const auto summary = engine.run(planned->plan, {});
  std::string said = summary ? summary->end.reason : summary.error().message;
  for (const auto& event : record.events)
    said += fmt::format("\n{:.3f} {}", event.time_s, event.message);
  for (const auto& p : record.points) {
    said += fmt::format("\n{} {} {} {} {} {} {} {} {}", p.time_s, p.rate_deg_per_h, p.temperature_c,
                        p.temperature_start_c, p.field_x_ut, p.field_y_ut, p.field_z_ut,
                        p.coil_current_a, p.count);
    for (const auto& [name, value] : p.auxiliary) said += fmt::format(" {} {}", name, value);
  }
  for (const auto& i : record.instrument_records) {
    said += fmt::format("\n{} {} {} {} {}", i.role, i.identity, i.serial_number, i.calibrated_on,
                        i.calibration_due);
  }
  return fmt::format("{}\n{:x}", said, trace.hash());
}

std::string clean_run(const Subject& subject) {
  return run_of(subject, {});
}

config::FaultSpec fault(const char* device, FaultKind kind, double at_s, double for_s) {
  return {device, kind, Seconds{at_s}, Seconds{for_s}};
}

/// Instruments fail while the run waits, the gyro again and again for less than an average bears.
std::string troubled_run(const Subject& subject) {
  std::vector<config::FaultSpec> faults{fault("thermostat", FaultKind::kStuck, 58.0, 8.0),
                                        fault("magnetometer", FaultKind::kStuck, 58.0, 5.0),
                                        fault("magnetometer", FaultKind::kTimeout, 66.0, 3.5),
                                        fault("thermostat", FaultKind::kSlowAnswer, 71.0, 6.0)};
  for (const auto& sensor : subject.setup.bench.auxiliary) {
    faults.push_back(fault(sensor.name.c_str(), FaultKind::kTimeout, 30.0, 5.5));
  }
  for (int i = 0; i < 30; ++i) {
    faults.push_back(fault("gyro", FaultKind::kTimeout, 4.0 + 4.0 * i, 0.05));
    faults.push_back(fault("gyro", FaultKind::kStuck, 6.0 + 4.0 * i, 0.04));
  }
  return run_of(subject, std::move(faults));
}

/// A supply is unplugged in a sweep.
std::string interrupted_run(const Subject& subject) {
  return run_of(subject, {fault("coil_vertical", FaultKind::kUnplug, 48.0, 20.0)});
}

std::string plan_of(const Subject& subject) {
  std::string said;
  for (const fs::path& procedure : {kReady / "procedures/acceptance.json", procedure_file(),
                                    kReady / "procedures/temperature-cycles.json"}) {
    const auto planned = plan_procedure(procedure, subject.setup.bench, {});
    if (!planned) {  // with the rates that the bench can
      said += planned.error().message + "\n";
      continue;
    }
    for (const auto& step : planned->plan.steps) {
      said += fmt::format("{} {} {}\n", step.path, step.says, step.estimate.count());
    }
    said += fmt::format("{}\n", fmt::join(planned->plan.limits_met, "\n"));
  }
  return said;
}

/// Everything that an interlock looks at grows worse for a while, then better again.
std::string interlocks_of(const Subject& subject) {
  procedures::Interlocks interlocks(subject.setup.bench);
  std::string said;
  procedures::Observation seen;
  for (int second = 0; second < 4000; ++second) {
    const double worse = second < 1500 ? second / 1500.0 : std::max(0.0, (3000 - second) / 1500.0);
    auto& t = seen.row.thermostat;
    t.working_1 = t.working_2 = config::Celsius{20.0 + 60.0 * worse};
    t.control = t.working_1 - config::Celsius{2.0 * worse};
    if (second >= 3000) {  // heating in vain, a little below its target in the end
      seen.commanded.target = config::Celsius{22.6};
      t.working_1 = t.working_2 =
          config::Celsius{second < 3950 ? 20.0 + 0.0004 * (second - 3000) : 21.5};
    }
    seen.row.time_s = second;
    seen.row.auxiliary["supply_v"] = 6.0 - 3.0 * worse;
    seen.commanded.field_ut = {{0.0, 0.0}};
    seen.row.field.field = {config::Microtesla{30.0 * worse}, {}, {}};
    seen.row.current_horizontal_a = 0.2 * worse;
    seen.gyro_silent_s = 10.0 * worse;
    seen.stream.frames_good += 1000;
    seen.stream.frames_invalid += static_cast<std::uint64_t>(1000.0 * worse);
    seen.today = *config::date_of("2026-06-01") + std::chrono::days(second * 20);
    for (const auto& change : interlocks.observe(seen)) {
      said += fmt::format("{} {} {} {}\n", second, change.tripped, static_cast<int>(change.action),
                          change.message);
    }
  }
  return said;
}

std::string rows_of(const drivers::ProbeReport& report) {
  std::string said;
  for (const auto& row : report.rows) {
    said += fmt::format("{} {} {} {} {}\n", row.name, row.raw, row.value.value_or(0.0), row.unit,
                        row.problem);
  }
  return said;
}

std::string probes_of(const Subject& subject) {
  const BenchConfig& bench = subject.setup.bench;
  PatternRegisters registers;
  PatternReports reports;
  drivers::VirtualClock clock;
  std::string said = rows_of(drivers::probe(bench.thermostat.device, registers, clock)) +
                     rows_of(drivers::probe(bench.magnetometer.device, reports));
  for (const auto& scpi :
       {bench.coil_horizontal.device, with_a_motor(bench).turntable.device.value()}) {
    support::FakeScpi far;
    support::FakeMessages messages(far);
    said += rows_of(drivers::probe(scpi, messages)) + fmt::format("{}", fmt::join(far.sent, "\n"));
  }
  const config::FrameDevice& gyro = bench.gyro.device;
  std::vector<std::uint8_t> frame(gyro.frame_bytes);
  for (std::size_t i = 0; i < frame.size(); ++i) frame[i] = pattern(i);
  std::copy(gyro.header.begin(), gyro.header.end(), frame.begin());
  drivers::Crc(gyro.crc).store(frame.data());
  support::FakeLine line;
  for (int i = 0; i < 3; ++i) line.put(frame);
  support::FakeSerial serial(line);
  return said + rows_of(drivers::probe(gyro, serial, clock));
}

/// What a simulated thermostat lets others write.
std::string writable_of(const Subject& subject) {
  const BenchConfig bench = with_a_motor(subject.setup.bench);
  drivers::VirtualClock clock;
  auto ends = simulator::simulate_bench(bench, scenario({}), 1, clock);
  if (!ends) return ends.error().message;
  std::string said;
  for (const auto& r : bench.thermostat.device.registers) {
    std::vector<std::uint16_t> words(
        r.type == config::NumberType::kInt16 || r.type == config::NumberType::kUint16 ? 1U : 2U);
    const Status written = ends->thermostat->write_registers(r.address, words);
    said += fmt::format("{} {}\n", r.name, written ? "written" : written.error().message);
  }
  std::uint16_t half = 0;
  const Status read =
      ends->thermostat->read_registers(bench.thermostat.device.registers[0].address, {&half, 1});
  return said + (read ? "half a number" : read.error().message);
}

template <class Device>
struct InstrumentAt {
  const Device& device;
  const std::string& connection;
};
template <class Device>
InstrumentAt(const Device&, const std::string&) -> InstrumentAt<Device>;

/// The unit that a Modbus instrument is asked by, on a line of the test's own.
template <class Device>
std::string unit_asked(const Device& device, drivers::Clock& clock) {
  support::Pty line;
  const auto port = drivers::open_port(device, "rtu:" + line.path() + ":9600", clock);
  if (!port) return port.error().message;
  std::thread asks([&transport = **port] {
    std::uint16_t word = 0;
    (void)transport.read_registers(0, {&word, 1});
  });
  const std::string unit = line.receive(1);
  line.unplug();  // an answer that nobody will send is not waited for
  asks.join();
  return fmt::format("unit {:02x}", fmt::join(unit, ""));
}

/// The speed that a line is opened at for what streams on it.
template <class Device>
std::string speed_of(const Device& device, drivers::Clock& clock) {
  const support::Pty line;
  const auto port = drivers::open_port(device, "tty:" + line.path(), clock);
  std::byte byte{};
  if (port) (void)(*port)->read_some({&byte, 1});  // the first use opens it
  struct termios2 speed {};
  ioctl(line.fd(), TCGETS2, &speed);
  return fmt::format("{} baud, ", speed.c_ospeed);
}

template <class Device>
std::string speed_or_unit_of(const Device& device, drivers::Clock& clock) {
  if constexpr (std::is_same_v<Device, config::ModbusSensor>) return unit_asked(device, clock);
  if constexpr (std::is_same_v<Device, config::LineSensor>) return speed_of(device, clock);
  return {};
}

/// Which ports a real bench is looked for at, and at which speed; the port is this machine's own.
std::string ports_of(const Subject& subject) {
  const BenchConfig& bench = subject.setup.bench;
  drivers::SteadyClock clock;
  std::string said;
  const auto open = [&](const auto& instrument) {
    if (instrument.connection == "simulated") return;
    const auto port = drivers::open_port(instrument.device, instrument.connection, clock);
    said += instrument.connection + (port ? "" : port.error().message) + "\n";
  };
  open(bench.thermostat);
  open(bench.coil_horizontal);
  open(bench.coil_vertical);
  open(bench.magnetometer);
  open(bench.gyro);
  if (bench.turntable.device && bench.turntable.connection != "simulated") {
    const auto port =
        drivers::open_port(*bench.turntable.device, bench.turntable.connection, clock);
    said += bench.turntable.connection + (port ? "" : port.error().message) + "\n";
  }
  for (const config::AuxiliaryConfig& sensor : bench.auxiliary) {
    said += std::visit(
        [&](const auto& device) {
          open(InstrumentAt{device, sensor.connection});
          return speed_or_unit_of(device, clock);
        },
        sensor.device);
  }
  return said + speed_of(bench.gyro.device, clock) + unit_asked(bench.thermostat.device, clock);
}

/// Keys that are for people: they are in the record as they were written.
std::string record_of(const Subject& subject) {
  return subject.setup.bench_json;
}

using Stage = std::string (*)(const Subject&);
constexpr Stage kStages[] = {plan_of,   interlocks_of, probes_of,       writable_of,
                             clean_run, troubled_run,  interrupted_run, ports_of};

/// The bench as the file has it; the error that refuses it.
Result<Subject> subject_of(const fs::path& bench) {
  auto setup = load_setup({.bench = bench.string()});
  if (!setup) return setup.error();
  return Subject{bench, std::move(*setup)};
}

/// Compares stage by stage, the cheap ones first, until one differs.
class Comparison {
 public:
  explicit Comparison(Subject original) : original_(std::move(original)) {}

  bool shows(const Subject& changed, bool for_people) {
    for (const Stage stage : kStages) {
      if (before(stage) != stage(changed)) return true;
    }
    return for_people && record_of(original_) != record_of(changed);
  }

 private:
  const std::string& before(Stage stage) {
    const auto [known, fresh] = known_.try_emplace(stage);
    if (fresh) known->second = stage(original_);
    return known->second;
  }
  Subject original_;
  std::map<Stage, std::string> known_;
};

bool is_sensor(const std::string& name) {
  const json device = json::parse(std::ifstream(kReady / name));
  return device.value("kind", "").ends_with("_sensor");
}

/// A bench of which one file, `name` below config/, is changed key by key.
class EveryKey : public testing::TestWithParam<std::string> {
 protected:
  EveryKey() {
    fs::create_directory(folder_.path() / "benches");
    fs::copy(kReady / "devices", folder_.path() / "devices");
  }
  /// The bench that names the file under test, or is it.
  json bench_for(const std::string& name) const {
    json bench = json::parse(
        std::ifstream(kReady / (name.starts_with("benches/") ? name : "benches/simulated.json")));
    const std::string device = "../" + name;
    if (name.starts_with("devices/thermostat")) bench["thermostat"]["device"] = device;
    if (name.starts_with("devices/gyro")) {
      bench["gyro"]["device"] = device;
      bench["gyro"].erase("frame_rate_hz");
    }
    if (is_sensor(name)) {
      json sensor{{"name", "sensor"}, {"device", device}};
      if (name.ends_with("hid.json")) sensor["connection"] = "hid:0x1209:0x0003:NOBODY";
      bench["auxiliary"] = json::array({sensor});
    }
    if (name.starts_with("devices/magnetometer")) {
      bench["magnetometer"].erase("calibration");
      bench["magnetometer"]["connection"] = "hid:0x1209:0x0001:NOBODY";
    }
    return bench;
  }
  Result<Subject> subject(const json& bench) const {
    const fs::path file = folder_.path() / "benches/bench.json";
    std::ofstream(file) << bench.dump();
    return subject_of(file);
  }

  support::TemporaryFolder folder_;
  support::OwnLocks locks_;
};

TEST_P(EveryKey, HasAnEffect) {
  const std::string& name = GetParam();
  const bool is_bench = name.starts_with("benches/");
  json bench = bench_for(name);
  if (is_bench) {
    bench.merge_patch(json::parse(kFurtherKeys));
    bench["simulation"]["gyro_frame_rate_hz"] =
        1.0005 * bench["gyro"]["frame_rate_hz"].get<double>();
  }
  json original = is_bench ? bench : json::parse(std::ifstream(kReady / name));
  original.erase("$schema");
  auto before = subject(bench);
  ASSERT_TRUE(before) << before.error().message;
  EXPECT_TRUE(clean_run(*before).starts_with("all steps done")) << clean_run(*before);
  Comparison comparison(std::move(*before));
  const auto again = subject(bench);
  ASSERT_TRUE(again) << again.error().message;
  ASSERT_FALSE(comparison.shows(*again, true)) << "nothing is changed yet";

  std::vector<std::string> without_effect;
  std::size_t keys = 0;
  const json leaves = original.flatten();
  for (const auto& [pointer, value] : leaves.items()) {
    ++keys;
    std::size_t accepted = 0;
    bool shown = false;
    for (const json& other : changes_of(pointer, value)) {
      if (other == value) continue;
      json changed = original;
      changed[json::json_pointer(pointer)] = other;
      if (!is_bench) std::ofstream(folder_.path() / name) << changed.dump();
      const auto after = subject(is_bench ? changed : bench);
      if (!after) {
        const std::string& says = after.error().message;
        EXPECT_EQ(says.find('\n'), std::string::npos) << says;
        // What is refused for the sake of another key has an effect on that one.
        shown = shown || says.find(pointer + ":") == std::string::npos;
        continue;
      }
      ++accepted;
      shown = shown || comparison.shows(*after, is_for_people(pointer));
      if (shown) break;
    }
    if (accepted > 0 && !shown) without_effect.push_back(pointer);
  }
  EXPECT_EQ(without_effect, std::vector<std::string>{}) << "of " << keys << " keys";
}

INSTANTIATE_TEST_SUITE_P(
    OfReadyFiles, EveryKey,
    testing::Values("benches/simulated.json", "benches/simulated-1khz.json", "benches/factory.json",
                    "benches/simulated-auxiliary.json", "benches/simulated-chamber.json",
                    "devices/barometer-modbus.json", "devices/hygrometer-lines.json",
                    "devices/light-meter-hid.json", "devices/voltmeter-scpi.json",
                    "devices/coil-kepco.json", "devices/gyro-crc8.json", "devices/gyro-kvh.json",
                    "devices/magnetometer-hid.json", "devices/thermostat-eurotherm.json",
                    "devices/thermostat-omron.json", "devices/thermostat-watlow.json",
                    "devices/turntable-scpi.json"),
    [](const auto& file) {
      std::string name = fs::path(file.param).stem().string();
      std::replace(name.begin(), name.end(), '-', '_');
      return name;
    });

TEST(EveryKeyTest, NamesEveryReadyFile) {
  std::size_t files = 0;
  for (const char* kind : {"benches", "devices"}) {
    for (const auto& entry : fs::directory_iterator(kReady / kind)) {
      if (entry.path().extension() == ".json") ++files;
    }
  }
  EXPECT_EQ(files, 17U) << "a new one belongs into the list above";
}

}  // namespace
}  // namespace fogbench::daemon
